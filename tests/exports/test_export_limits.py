"""Each format at the edge of what it can hold: all of it is in the file, or the file is refused before it is written."""

import json
import re
import struct
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import c3d
import numpy as np
import pytest

from mocapd.app.recordings.exporting import motion_of
from mocapd.errors import CannotCreateError, InputError
from mocapd.exports import formats
from mocapd.exports.c3d.c3d_writer import frames_in_c3d, write_c3d
from mocapd.exports.formats import FORMATS, write_export
from mocapd.exports.glb.glb_writer import glb_bytes, most_glb_frames
from mocapd.exports.sampled_motion import MOST_FRAMES, SampledMotion
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.types import Skeleton
from tests.exports.exported import by_ezc3d, recorded_motion

pytestmark = pytest.mark.filterwarnings("ignore:No analog data")


def long_motion(frames: int, joints: int = 1, rate_hz: float = 60.0) -> SampledMotion:
    """A chain of joints; x of the first is the number of the frame [mm]. Of each frame only that is in memory."""
    names = tuple(f"joint{j}" for j in range(joints))
    rest_m = np.outer(np.arange(joints), [0.0, 0.1, 0.0])
    parents = np.arange(joints) - 1
    joints_m = np.broadcast_to(rest_m, (frames, joints, 3))
    if joints == 1:
        joints_m = np.zeros((frames, 1, 3))
        joints_m[:, 0, 0] = np.arange(frames) / 1000.0
    turns = np.broadcast_to([0.0, 0.0, 0.0, 1.0], (frames, joints, 4))
    ones = np.broadcast_to(1.0, (frames, joints))
    gap = np.zeros(frames, dtype=np.uint8)
    near_m = np.broadcast_to(0.01, (frames, joints))
    return SampledMotion(
        rate_hz, Skeleton(names, parents, rest_m), joints_m, turns, ones, gap, near_m
    )


@pytest.mark.parametrize("frames", [1, 65_534, 65_535, 65_536, 65_537, 131_072])
def test_every_frame_of_a_long_c3d_is_read_by_ezc3d_and_announced_to_c3d(
    tmp_path: Path, frames: int
) -> None:
    path = tmp_path / "a.c3d"
    write_c3d(long_motion(frames), path)
    points = by_ezc3d(path)["data"]["points"]
    assert points[0, 0] == pytest.approx(np.arange(frames), abs=0.01)
    assert frames_in_c3d(path) == frames
    with path.open("rb") as file:
        reader = c3d.Reader(file)
        assert (reader.first_frame, reader.last_frame, reader.frame_count) == (1, frames, frames)
        assert reader.get("TRIAL:ACTUAL_END_FIELD").uint16_array.tolist() == [
            frames & 0xFFFF,
            frames >> 16,
        ]
        if frames >= 65_535:
            assert reader.get("POINT:LONG_FRAMES").float_value == frames


def test_every_frame_of_a_long_c3d_is_read_by_c3d(tmp_path: Path) -> None:
    path = tmp_path / "a.c3d"
    write_c3d(long_motion(65_540), path)
    with path.open("rb") as file:
        found = [points[0, 0] for _, points, _ in c3d.Reader(file).read_frames()]
    assert found == pytest.approx(np.arange(65_540), abs=0.01)


def test_a_recording_over_65535_frames_is_exported_whole(tmp_path: Path, shared_dir: Path) -> None:
    recording = shared_dir / "findings/reports-2026-11-26/07-long-c3d/long.mcap"
    if not recording.exists():
        pytest.skip("no such finding here")
    motion = motion_of(RecordingReader(recording), 0, 1000.0).motion
    assert len(motion.joints_m) == 69_834
    write_export(motion, "c3d", tmp_path / "long.c3d")
    points = by_ezc3d(tmp_path / "long.c3d")["data"]["points"][:3]
    joints_m = np.moveaxis(points, (0, 1, 2), (2, 1, 0)) / 1000.0
    assert np.abs(joints_m - motion.joints_m).max() < 1e-4


@pytest.mark.parametrize("joints", [254, 255, 256, 600])
def test_c3d_names_every_joint(tmp_path: Path, joints: int) -> None:
    """One parameter holds 255 names."""
    motion = long_motion(2, joints)
    write_c3d(motion, tmp_path / "a.c3d")
    point = by_ezc3d(tmp_path / "a.c3d")["parameters"]["POINT"]
    parts = [point[name]["value"] for name in ("LABELS", "LABELS2", "LABELS3") if name in point]
    assert tuple(name for part in parts for name in part) == motion.skeleton.names


@pytest.mark.parametrize("width", [1, 63, 64])
def test_the_longest_names_are_in_every_format(tmp_path: Path, width: int) -> None:
    motion = recorded_motion()
    names = tuple(f"{number:x}".rjust(width, "a")[:width] for number in range(22))
    motion = replace(motion, skeleton=replace(motion.skeleton, names=names))
    for name in FORMATS:
        if name != "vrma":  # which has bones of a VRM avatar alone
            write_export(motion, name, tmp_path / f"a.{name}")
    assert tuple(by_ezc3d(tmp_path / "a.c3d")["parameters"]["POINT"]["LABELS"]["value"]) == names
    assert set(re.findall(r"(?:ROOT|JOINT) (\S+)", (tmp_path / "a.bvh").read_text())) == {*names}
    assert [n for n in (tmp_path / "a.trc").read_text().split("\n")[3].split("\t") if n][2:] == [
        *names
    ]


@pytest.mark.parametrize("rate_hz", [1.0, 29.97, 119.8801, 1000.0])
def test_rates_are_kept(tmp_path: Path, rate_hz: float) -> None:
    motion = replace(recorded_motion(), rate_hz=rate_hz)
    for name in FORMATS:
        write_export(motion, name, tmp_path / f"a.{name}")
    rate = by_ezc3d(tmp_path / "a.c3d")["parameters"]["POINT"]["RATE"]["value"][0]
    assert rate == pytest.approx(rate_hz, rel=1e-6)
    assert float((tmp_path / "a.trc").read_text().split("\n")[2].split("\t")[0]) == rate_hz
    bvhio = pytest.importorskip("bvhio")  # has no wheel for Python 3.14
    told_s = bvhio.readAsBvh(str(tmp_path / "a.bvh")).FrameTime
    assert 1.0 / told_s == pytest.approx(rate_hz, rel=1e-6)


def test_a_file_of_over_65535_frames_is_whole_in_text_too(tmp_path: Path) -> None:
    motion = long_motion(65_537)
    for name in ("bvh", "csv", "trc"):
        write_export(motion, name, tmp_path / f"a.{name}")
    assert "Frames: 65537" in (tmp_path / "a.bvh").read_text()
    rows = {n: (tmp_path / f"a.{n}").read_text().rstrip("\n").split("\n") for n in ("trc", "csv")}
    assert rows["trc"][-1].startswith("65537\t")
    assert len(rows["csv"]) == 65_538


def test_a_glb_is_no_longer_than_its_header_can_count() -> None:
    """What is foretold of a file's length holds for a short one: 4 bytes of time a frame, 29 of each joint."""
    for joints in (1, 22, 60):
        motion = long_motion(3, joints)
        frames = most_glb_frames(joints)
        there = len(glb_bytes(motion)) - 3 * (4 + 29 * joints)
        assert there + frames * (4 + 29 * joints) < 2**32
    times = (np.arange(most_glb_frames(1)) / 1000.0).astype(np.float32)
    assert (np.diff(times) > 0).all()


def test_what_a_glb_cannot_hold_is_refused_with_the_rate_that_fits(tmp_path: Path) -> None:
    frames = most_glb_frames(22) + 1
    with pytest.raises(InputError, match=r"GLB holds \d+, .* at 1000 Hz -- .*--rate: 999\.99 Hz"):
        write_export(long_motion(frames, 22, 1000.0), "glb", tmp_path / "a.glb")
    assert not list(tmp_path.iterdir())


def test_every_format_but_gltf_holds_the_longest_motion() -> None:
    limited = {name for name, one in FORMATS.items() if one.most_frames(22) < MOST_FRAMES}
    assert limited == {"glb", "vrma"}


def _cut_c3d(data: bytes) -> bytes:
    return data[:-600]


def _cut_line(data: bytes) -> bytes:
    return data[: data.rstrip(b"\n").rindex(b"\n") + 1]


def _cut_bin(data: bytes) -> bytes:
    return data[:-4]


@pytest.mark.parametrize(
    ("name", "cut"),
    [
        ("c3d", _cut_c3d),
        ("bvh", _cut_line),
        ("csv", _cut_line),
        ("trc", _cut_line),
        ("glb", _cut_bin),
        ("vrma", _cut_bin),
    ],
)
def test_a_file_that_holds_less_than_was_meant_is_an_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, cut: Callable[[bytes], bytes]
) -> None:
    whole = FORMATS[name]

    def write_less(motion: SampledMotion, path: Path, said: str) -> None:
        whole.write(motion, path, said)
        path.write_bytes(cut(path.read_bytes()))

    monkeypatch.setattr(formats, "FORMATS", {name: replace(whole, write=write_less)})
    motion = recorded_motion()
    with pytest.raises(CannotCreateError, match="of 90 frames are readable"):
        write_export(motion, name, tmp_path / f"a.{name}")
    assert not (tmp_path / f"a.{name}").exists()


def test_every_byte_of_a_glb_is_accounted_for(tmp_path: Path) -> None:
    motion = recorded_motion()
    data = glb_bytes(motion)
    magic, version, length, size = struct.unpack_from("<4sIII", data)
    assert (magic, version, length) == (b"glTF", 2, len(data))
    (buffer,) = json.loads(data[20 : 20 + size])["buffers"]
    assert len(data) - 28 - size - buffer["byteLength"] in range(4)
