"""Seconds of compiling for each kernel that a first start needs, and the table that a first start goes by.

    python -m lab.kernel_seconds [--write] [--least 0.2]

Compiles everything into an empty folder: what draws the demo's film, what makes the pose database, and the
trackers `shirt`, `markerless` and `auto`, each in a process of its own that finds what those before it compiled. Prints the
dearest first, in seconds of CPU, and what is compiled for several argument types. --write: writes calib/kernels.json, in
seconds of the machine that the table was first made on.
"""

import gc
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from msgspec.structs import replace

from lab.command_line import run
from mocapd.app.libraries import use_cache_dir
from mocapd.assets import asset_path
from mocapd.sim.scenario import load_scenario

if TYPE_CHECKING:
    from mocapd.shirt.pose_database.database import PoseDatabase
    from mocapd.sim.scenario import CameraSpec, Scenario

SCENARIO = "living_room"
TRACKERS = {"shirt": "shirt", "clothes": "markerless", "auto": "auto"}
_FRAMES = 3
_LISTED = 4  # of what numba compiles for itself


def _quiet(*_: object) -> None:
    """Progress that nobody looks at."""


def _scenario() -> "Scenario":
    """The demo's, with few frames, and a quarter of the pixels: kernels do not depend on either."""
    scenario = load_scenario(asset_path(f"scenarios/{SCENARIO}.toml"))
    cameras = [_halved(camera) for camera in scenario.cameras]
    return replace(scenario, fps_hz=_FRAMES / scenario.loop_s, cameras=cameras)


def _halved(camera: "CameraSpec") -> "CameraSpec":
    (width, height), focal_px, centre_px = camera.size_px, camera.focal_px, camera.centre_px
    assert focal_px is not None
    assert centre_px is not None
    return replace(
        camera,
        size_px=(width // 2, height // 2),
        focal_px=(focal_px[0] / 2, focal_px[1] / 2),
        centre_px=(centre_px[0] / 2, centre_px[1] / 2),
    )


def _small_database(cache: Path) -> "PoseDatabase":
    from mocapd.shirt.pose_database.database import DatabaseParams
    from mocapd.shirt.pose_database.database_file import load_or_build

    return load_or_build(cache, DatabaseParams(count=3000, cells=32)).database


def _film(cache: Path) -> None:
    from mocapd.sim.film import load_film

    load_film(_scenario(), cache)


def _tracker(stage: str, cache: Path) -> None:
    from mocapd.calibration.calibration_record import ShirtColours
    from mocapd.calibration.from_origin import from_origin
    from mocapd.capture.simulated.film_origin import open_film
    from mocapd.clock import monotonic_ns
    from mocapd.pipeline.rehearsal import rehearse
    from mocapd.session.worker_thread import each_camera
    from mocapd.tracking.build import build_body_tracker
    from mocapd.tracking.tracker_inputs import wearer_shape

    name = TRACKERS[stage]
    known = from_origin(open_film(f"sim:{SCENARIO}", _scenario(), cache, _quiet, None))
    database = _small_database(cache) if name != "markerless" else None
    tracker = build_body_tracker(
        name, known, database, name != "shirt", each=each_camera(), now_ns=monotonic_ns
    )
    shirt = known.shirt or ShirtColours()
    pictures = {camera: one.pixels for camera, one in shirt.white_balance.items()}
    rehearse(tracker, wearer_shape(known), known.rig, pictures, _quiet)


STAGES: Mapping[str, Callable[[Path], object]] = {
    "film": _film,
    "database": _small_database,
    **{stage: partial(_tracker, stage) for stage in TRACKERS},
}


def _key(module: str, function: str, types: Any) -> str:
    return json.dumps([f"{module}.{function}", types])


def compile_stage(stage: str, cache: Path) -> None:
    """In this process; prints what was compiled, and what was used, as JSON."""
    from numba.core.dispatcher import Dispatcher

    from lab.compile_events import compile_events
    from mocapd.kernels.type_codes import encode

    gc.disable()  # as in the processes of a first start
    with compile_events() as compiled:
        STAGES[stage](cache)
    found = [
        [_key(one.module, one.function, [encode(t) for t in one.arguments]), one.own_s, one.total_s]
        for one in compiled
        if one.module.startswith("mocapd.")
    ]
    used = {
        _key(kernel.py_func.__module__, kernel.py_func.__qualname__, [encode(t) for t in types])
        for module in [one for name, one in sys.modules.items() if name.startswith("mocapd.")]
        for kernel in vars(module).values()
        if isinstance(kernel, Dispatcher) and kernel.py_func.__module__.startswith("mocapd.")
        for types in kernel.overloads
    }
    inside: dict[str, float] = {}
    for one in compiled:
        if not one.module.startswith("mocapd."):
            inside[one.function] = inside.get(one.function, 0.0) + one.own_s
    sys.stdout.write(json.dumps({"compiled": found, "used": sorted(used), "numba": inside}))


def _measured(cache: Path) -> list[dict[str, Any]]:
    """Rows of the table, callees before callers."""
    rows: dict[str, dict[str, Any]] = {}
    for stage in STAGES:
        began_s = time.monotonic()
        done = subprocess.run(
            [sys.executable, "-m", "lab.kernel_seconds", "--stage", stage, "--cache", cache],
            check=True, stdout=subprocess.PIPE, env=os.environ | {"NUMBA_CACHE_DIR": str(cache / "numba")},
        )  # fmt: skip
        said = json.loads(done.stdout)
        for key, own_s, total_s in said["compiled"]:
            kernel, types = json.loads(key)
            rows[key] = {
                "kernel": kernel,
                "types": types,
                "seconds": own_s,
                "total": total_s,
                "stages": {stage},
            }
        for key in said["used"]:
            rows[key]["stages"].add(stage)
        sys.stderr.write(
            f"{stage}: {len(said['compiled'])} compiled, {sum(one[1] for one in said['compiled']):.1f} s, "
            f"and {sum(said['numba'].values()):.1f} s of numba's own, most of it {_most(said['numba'])}; "
            f"{time.monotonic() - began_s:.0f} s by the clock\n"
        )
    return list(rows.values())


def kernel_seconds(
    write: Annotated[bool, typer.Option("--write", help="Write calib/kernels.json.")] = False,
    least: Annotated[float, typer.Option(help="Only kernels of so many seconds are listed.")] = 0.2,
    stage: Annotated[str | None, typer.Option(hidden=True)] = None,
    cache: Annotated[Path | None, typer.Option(hidden=True)] = None,
) -> None:
    """Print seconds of compiling for each kernel that a first start needs."""
    if stage is not None and cache is not None:
        use_cache_dir(cache)
        compile_stage(stage, cache)
        return
    with tempfile.TemporaryDirectory() as folder:
        rows = _measured(Path(folder))
    say = sys.stdout.write
    say("| kernel | own [s] | with callees [s] | needed by |\n|---|---|---|---|\n")
    for row in sorted(rows, key=lambda one: -float(one["seconds"])):
        if row["seconds"] >= least:
            say(
                f"| {row['kernel']} | {row['seconds']:.2f} | {row['total']:.2f} | {', '.join(sorted(row['stages']))} |\n"
            )
    say(f"| all {len(rows)} | {sum(row['seconds'] for row in rows):.1f} | | |\n")
    _say_several(rows)
    from mocapd.app.daemon.first_start_tasks import machine_pace  # it imports numba

    pace = machine_pace()
    say(f"this machine takes {pace:.2f} of the time of the table's\n")
    if write:
        rows = [row | {"seconds": row["seconds"] / pace} for row in rows]
        text = ",\n".join(json.dumps(_kept(row)) for row in rows)
        asset_path("body_proportions.json").with_name("kernels.json").write_text(f"[\n{text}\n]\n")


def _most(seconds: Mapping[str, float]) -> str:
    dearest = sorted(seconds.items(), key=lambda one: -one[1])[:_LISTED]
    return ", ".join(f"{what} {of_s:.1f} s" for what, of_s in dearest)


def _kept(row: dict[str, Any]) -> dict[str, Any]:
    return {
        "kernel": row["kernel"], "seconds": round(row["seconds"], 2), "stages": sorted(row["stages"]), "types": row["types"],
    }  # fmt: skip


def _say_several(rows: list[dict[str, Any]]) -> None:
    """Which kernels are compiled for several argument types, and in which arguments those differ."""
    by_kernel: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        by_kernel.setdefault(row["kernel"], []).append(row)
    for kernel, several in by_kernel.items():
        if len(several) > 1:
            differing = [
                set(map(json.dumps, one))
                for one in zip(*(row["types"] for row in several), strict=False)
            ]
            said = "; ".join(
                f"argument {i}: {' or '.join(sorted(one))}"
                for i, one in enumerate(differing)
                if len(one) > 1
            )
            sys.stdout.write(f"{kernel}: {sum(row['seconds'] for row in several):.2f} s: {said}\n")


if __name__ == "__main__":
    run(kernel_seconds)
