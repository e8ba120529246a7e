"""BVH and GLB in headless Blender, joint by joint against the CSV of the same recording, and the GLB's figure about them."""

import csv
import json
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mocapd.types import Floats
from tests.engines.chroot import Chroot
from tests.engines.results import Result, at_most
from tests.outputs.recorded import frames, record

WHERE = "Blender"
JOINTS_CM = 0.1
FIGURE_CM = 15.0  # half of the trunk's thickness
SECONDS = 9.0
RECORDED_HZ = 25.0  # no rate of Blender's own
EXPORTED_HZ = 30.0
CM = 100.0
SCRIPT = Path(__file__).with_name("blender") / "look.py"
ROOT = Path(__file__).resolve().parents[2]


def blender_checks(chroot: Chroot, work: Path, logs: Path) -> Iterator[Result]:
    """work: an empty folder inside of the chroot."""
    recording = record(work / "motion.mcap", frames(SECONDS, RECORDED_HZ))
    for kind in ("csv", "bvh", "glb"):
        _export(recording, kind)
    truth_m = _table(recording.with_suffix(".csv"))
    script = Path(shutil.copy(SCRIPT, work))
    for kind in ("bvh", "glb"):
        log, out = logs / f"{kind}.log", work / f"{kind}.json"
        file = recording.with_suffix(f".{kind}")
        words = [kind, chroot.inside(file), chroot.inside(out), f"{EXPORTED_HZ:g}"]
        words.append(str(len(next(iter(truth_m.values())))))
        blender = ["blender", "-b", "--factory-startup", "--python-exit-code", "9", "--python"]
        chroot.run([*blender, chroot.inside(script), "--", *words], log)
        if not out.is_file():
            yield Result(WHERE, f"{kind.upper()} imported", f"no; see {log}", "yes", False)
            continue
        seen = json.loads(out.read_text())
        yield _compared(kind, seen, truth_m)
        if kind == "glb":
            yield _worn(seen["figure"], len(seen["poses"]))


def _compared(kind: str, seen: dict[str, object], truth_m: dict[str, Floats]) -> Result:
    poses = seen["poses"]
    assert isinstance(poses, list)
    missing = truth_m.keys() - poses[0].keys()
    if missing:
        return Result(WHERE, f"{kind.upper()}, bones", f"lacks {', '.join(missing)}", "all", False)
    errors_m = [
        np.linalg.norm(np.array([pose[name] for pose in poses]) - at_m, axis=1).max()
        for name, at_m in truth_m.items()
    ]
    what = f"{kind.upper()}, {len(truth_m)} joints in {len(poses)} frames, greatest error"
    return at_most(WHERE, what, CM * float(max(errors_m)), JOINTS_CM, "cm")


def _worn(figure: list[dict[str, float]], n_frames: int) -> Result:
    """Whether one skinned figure has every joint within it, or just outside, in every frame."""
    if len(figure) != n_frames:
        return Result(WHERE, "GLB, figure", "no mesh that the armature moves", "one", False)
    farthest_m = max(max(frame.values()) for frame in figure)
    what = f"GLB, joint farthest from the figure's nearest vertex in {n_frames} frames"
    return at_most(WHERE, what, CM * farthest_m, FIGURE_CM, "cm")


def _export(recording: Path, kind: str) -> None:
    command = [sys.executable, "-m", "mocapd.cli.main", "export", str(recording), "--to", kind]
    command += ["--rate", f"{EXPORTED_HZ:g}"]
    subprocess.run(command, cwd=ROOT, capture_output=True, check=True)


def _table(path: Path) -> dict[str, Floats]:
    """Of each joint its places (F,3) [m]."""
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    names = [column.removesuffix("_x") for column in rows[0] if column.endswith("_x")]
    return {
        name: np.array([[float(row[f"{name}_{axis}"]) for axis in "xyz"] for row in rows])
        for name in names
    }
