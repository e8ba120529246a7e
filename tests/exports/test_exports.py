"""Every format, read back by another library: joints in the world as recorded, to a millimetre."""

import csv
from pathlib import Path

import c3d
import numpy as np
import pytest

from mocapd.exports.formats import FORMATS
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.geometry import rotations
from mocapd.types import Floats
from tests.cli.mocapd_process import Outcome, mocapd_here
from tests.exports.exported import SECONDS, by_ezc3d, check_places, exported
from tests.exports.gltf_reading import load, rows_of
from tests.outputs.recorded import HZ, frames, record

FRAMES = round(SECONDS * HZ)


def test_bvh_by_bvhio(tmp_path: Path) -> None:
    bvhio = pytest.importorskip("bvhio")  # has no wheel for Python 3.14
    motion, path = exported(tmp_path, "bvh")
    root = bvhio.readAsHierarchy(str(path))
    places = []
    for number in range(len(motion.joints_m)):
        root.loadPose(number)
        by_name = {joint.Name: joint.PositionWorld for joint, _, _ in root.layout()}
        places.append([list(by_name[name]) for name in motion.skeleton.names])
    check_places(np.array(places) / 100.0, motion)
    told = bvhio.readAsBvh(str(path))
    assert told.FrameCount == FRAMES
    assert told.FrameTime == pytest.approx(1.0 / HZ, rel=1e-6)


def test_glb_by_pygltflib(tmp_path: Path) -> None:
    motion, path = exported(tmp_path, "glb")
    file = load(path)
    (animation,) = file.animations
    times_s = rows_of(file, animation.samplers[0].input)[:, 0]
    assert times_s == pytest.approx(motion.times_s, abs=1e-6)
    moved: dict[tuple[int, str], Floats] = {
        (channel.target.node, channel.target.path): rows_of(
            file, animation.samplers[channel.sampler].output
        )
        for channel in animation.channels
    }
    places: dict[int, Floats] = {}
    turns: dict[int, Floats] = {}

    def pose(node: int, place_m: Floats, turn: Floats) -> None:
        places[node] = place_m + rotations.rotate(turn, moved[node, "translation"])
        turns[node] = rotations.multiply(turn, moved[node, "rotation"])
        for child in file.nodes[node].children or ():
            pose(child, places[node], turns[node])

    root, _figure = file.scenes[file.scene].nodes
    pose(root, np.zeros((FRAMES, 3)), np.tile(rotations.IDENTITY_XYZW, (FRAMES, 1)))
    names = [file.nodes[node].name for node in file.skins[0].joints]
    assert tuple(names) == motion.skeleton.names
    check_places(np.stack([places[node] for node in file.skins[0].joints], axis=1), motion)
    steps = np.vecdot(moved[7, "rotation"][1:], moved[7, "rotation"][:-1])
    assert (steps > 0).all()  # or a player would turn the long way round


def test_the_rest_pose_of_a_glb_is_the_t_pose(tmp_path: Path) -> None:
    motion, path = exported(tmp_path, "glb")
    file = load(path)
    inverse = rows_of(file, file.skins[0].inverseBindMatrices).reshape(-1, 4, 4)
    assert np.allclose(-inverse[:, 3, :3], motion.skeleton.rest_m, atol=1e-6)


def test_c3d_by_ezc3d(tmp_path: Path) -> None:
    motion, path = exported(tmp_path, "c3d")
    file = by_ezc3d(path)
    point = file["parameters"]["POINT"]
    assert point["UNITS"]["value"] == ["mm"]
    assert point["RATE"]["value"][0] == pytest.approx(HZ)
    assert tuple(point["LABELS"]["value"]) == motion.skeleton.names
    assert (point["X_SCREEN"]["value"], point["Y_SCREEN"]["value"]) == (["+X"], ["+Y"])
    check_places(np.moveaxis(file["data"]["points"][:3], (0, 1, 2), (2, 1, 0)) / 1000.0, motion)


@pytest.mark.filterwarnings("ignore:No analog data")
def test_c3d_by_c3d(tmp_path: Path) -> None:
    motion, path = exported(tmp_path, "c3d")
    with path.open("rb") as file:
        reader = c3d.Reader(file)
        assert reader.point_rate == pytest.approx(HZ)
        assert tuple(name.strip() for name in reader.point_labels) == motion.skeleton.names
        points = np.stack([points for _, points, _ in reader.read_frames()])
    assert (points[..., 3] == 0.0).all()  # none is invalid
    check_places(points[..., :3] / 1000.0, motion)


def test_csv_by_the_standard_library(tmp_path: Path) -> None:
    motion, path = exported(tmp_path, "csv")
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    names = motion.skeleton.names
    places = [[[float(row[f"{n}_{axis}"]) for axis in "xyz"] for n in names] for row in rows]
    check_places(np.array(places), motion)
    assert [float(row["time_s"]) for row in rows] == pytest.approx(list(motion.times_s), abs=1e-6)
    turned = [[[float(row[f"{n}_q{axis}"]) for axis in "xyzw"] for n in names] for row in rows]
    assert np.abs(np.array(turned) - motion.global_xyzw).max() < 1e-5


def test_csv_has_an_uncertainty_only_where_one_is_known(tmp_path: Path) -> None:
    _, path = exported(tmp_path, "csv")
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert {float(row["leftHand_uncertainty_m"]) for row in rows} == {0.1001}
    assert {row["leftFoot_uncertainty_m"] for row in rows} == {""}


def test_trc_as_its_tables_say(tmp_path: Path) -> None:
    """Read by hand: the format has no library that is kept."""
    motion, path = exported(tmp_path, "trc")
    lines = [line.split("\t") for line in path.read_text().split("\n")]
    told = dict(zip(lines[1], lines[2], strict=True))
    assert (told["Units"], told["NumFrames"]) == ("mm", str(FRAMES))
    assert float(told["DataRate"]) == HZ
    assert tuple(name for name in lines[3][2:] if name) == motion.skeleton.names
    rows = np.array([[float(x) for x in line] for line in lines[6:] if len(line) > 1])
    assert rows[:, 0].tolist() == list(range(1, FRAMES + 1))
    check_places(rows[:, 2:].reshape(FRAMES, -1, 3) / 1000.0, motion)


def test_gaps_are_empty_where_the_format_can(tmp_path: Path) -> None:
    from mocapd.exports.formats import write_export

    motion = _with_gap(exported(tmp_path, "trc")[0])
    for name in ("trc", "csv", "c3d"):
        write_export(motion, name, tmp_path / f"gap.{name}")
    line = (tmp_path / "gap.trc").read_text().split("\n")[6 + 40].split("\t")
    assert set(line[2:]) == {""}
    points = by_ezc3d(tmp_path / "gap.c3d")["data"]["points"]
    assert np.isnan(points[:3, :, 40]).all()
    assert np.isfinite(points[:3, :, 39]).all()
    assert (tmp_path / "gap.csv").read_text().split("\n")[1 + 40].split(",")[1] == "1"


def _with_gap(motion: SampledMotion) -> SampledMotion:
    from dataclasses import replace

    gap = motion.gap.copy()
    gap[40] = 1
    return replace(motion, gap=gap)


@pytest.mark.parametrize("name", FORMATS)
def test_an_export_never_replaces_its_recording(
    clean_env: dict[str, str], tmp_path: Path, name: str
) -> None:
    recording = record(tmp_path / "a.mcap", frames(0.2))
    before, beside = recording.read_bytes(), tmp_path / f"a.{name}"

    def export(*words: str | Path) -> Outcome:
        return mocapd_here(clean_env, "export", recording, "--to", name, *words)

    for words in (("--out", recording), ("--out", recording, "--force")):
        refused = export(*words)
        assert refused.code == 73
        assert "is what the command reads" in refused.err
    assert recording.read_bytes() == before
    assert export().code == 0
    assert (export().code, export("--force").code) == (73, 0)
    beside.write_text("my notes")
    assert "is there already, and is not a" in export().err
    assert beside.read_text() == "my notes"
    assert export("--force").code == 0
    assert beside.read_bytes() != b"my notes"
