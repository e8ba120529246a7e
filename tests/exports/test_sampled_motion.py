"""A recording at a constant rate: between its poses, across its gaps."""

from pathlib import Path

import msgspec
import numpy as np
import pytest

from mocapd.app.recordings.exporting import motion_of
from mocapd.errors import CannotCreateError, InputError
from mocapd.exports.bvh.bvh_writer import zxy_degrees
from mocapd.exports.formats import write_export
from mocapd.exports.sampled_motion import usual_rate_hz
from mocapd.geometry import rotations
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from tests.cli.mocapd_process import mocapd, mocapd_here
from tests.outputs.recorded import frame_at, frames, moving_body, record, rest


def test_uneven_frames_become_an_even_motion(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    times_s = np.sort(np.arange(90) / 60.0 + rng.uniform(-0.004, 0.004, 90))
    uneven = [frame_at(float(t_s), number) for number, t_s in enumerate(times_s)]
    found = motion_of(RecordingReader(record(tmp_path / "a.mcap", uneven)), 0, 100.0).motion
    assert found.rate_hz == 100.0
    assert not found.gap.any()
    for number in range(0, len(found.joints_m), 7):
        body = moving_body(float(times_s[0]) + number / 100.0)
        assert body.pose is not None
        assert body.joints_m is not None
        assert np.linalg.norm(found.joints_m[number] - body.joints_m, axis=1).max() < 2e-3
        turned = rotations.angle_rad(found.global_xyzw[number], body.pose.quats_xyzw)
        assert turned.max() < 5e-3


def test_a_gap_is_said_and_carried_over(tmp_path: Path) -> None:
    all_frames = frames(3.0)
    lost = [
        msgspec.structs.replace(one, tracking="lost", joints={}) if 60 <= one.seq < 120 else one
        for one in all_frames
    ]
    found = motion_of(RecordingReader(record(tmp_path / "a.mcap", lost)), 0, None)
    assert (found.tracked, found.lost) == (120, 60)
    assert len(found.motion.joints_m) == 180
    assert found.motion.gap.nonzero()[0].tolist() == list(range(60, 120))
    assert (found.motion.confidence[60:120] == 0).all()
    assert np.isinf(found.motion.uncertainty_m[60:120]).all()
    assert np.isfinite(found.motion.uncertainty_m[:60, 0]).all()
    assert np.isfinite(found.motion.joints_m).all()


@pytest.mark.parametrize("set_s", [-3600, -1, 3600])
def test_a_clock_that_is_set_neither_costs_frames_nor_adds_any(tmp_path: Path, set_s: int) -> None:
    def later(one: SkeletonFrame) -> SkeletonFrame:
        return msgspec.structs.replace(one, capture_unix_ns=one.capture_unix_ns + set_s * 10**9)

    jumped = [later(one) if one.seq >= 60 else one for one in frames(2.0)]
    found = motion_of(RecordingReader(record(tmp_path / "a.mcap", jumped)), 0, None)
    assert (found.tracked, len(found.motion.joints_m), int(found.motion.gap.sum())) == (120, 120, 0)


@pytest.mark.parametrize(("set_s", "count"), [(2, 240), (-7200, 179)])
def test_a_machine_that_is_started_again_leaves_a_gap(
    tmp_path: Path, set_s: int, count: int
) -> None:
    """Where its Unix clock is behind afterwards, of a second."""

    def later(one: SkeletonFrame) -> SkeletonFrame:
        return msgspec.structs.replace(
            one,
            capture_unix_ns=one.capture_unix_ns + set_s * 10**9,
            capture_monotonic_ns=one.capture_monotonic_ns - 5 * 10**9,
        )

    again = [later(one) if one.seq >= 60 else one for one in frames(2.0)]
    found = motion_of(RecordingReader(record(tmp_path / "a.mcap", again)), 0, None)
    assert (found.tracked, len(found.motion.joints_m)) == (120, count)


def test_one_frame_is_a_motion(tmp_path: Path) -> None:
    found = motion_of(RecordingReader(record(tmp_path / "a.mcap", frames(1 / 60))), 0, None).motion
    assert len(found.joints_m) == 1
    for name in ("bvh", "glb", "csv", "trc", "c3d"):
        write_export(found, name, tmp_path / f"a.{name}")


def test_the_rate_is_that_of_the_recording() -> None:
    assert usual_rate_hz(np.arange(10) * 16_666_667) == pytest.approx(60.0)
    assert usual_rate_hz(np.array([5])) == 30.0


def test_nobody_in_it_is_named(tmp_path: Path) -> None:
    lost = [msgspec.structs.replace(one, tracking="lost", joints={}) for one in frames(0.1)]
    reader = RecordingReader(record(tmp_path / "a.mcap", lost))
    with pytest.raises(InputError, match="tracked nowhere"):
        motion_of(reader, 0, None)
    with pytest.raises(InputError, match=r"no rest skeleton of person 3 .*--person: 0"):
        motion_of(reader, 3, None)


def test_frames_of_another_skeleton_are_counted(tmp_path: Path) -> None:
    def without_hands(one: SkeletonFrame) -> SkeletonFrame:
        kept = {name: joint for name, joint in one.joints.items() if "Hand" not in name}
        return msgspec.structs.replace(one, joints=kept)

    mixed = [without_hands(one) if one.seq < 10 else one for one in frames(0.5)]
    found = motion_of(RecordingReader(record(tmp_path / "a.mcap", mixed)), 0, None)
    assert (found.tracked, found.lost, found.other_skeleton) == (20, 0, 10)


@pytest.mark.parametrize(
    "damaged",
    [
        {"parents": (-1, -1, *rest().parents[2:])},
        {"names": ("left hip", *rest().names[1:])},
        {"names": ("spine", *rest().names[1:])},
        {"names": ("h" * 65, *rest().names[1:])},
    ],
)
def test_a_skeleton_that_no_format_holds_is_refused(
    tmp_path: Path, damaged: dict[str, object]
) -> None:
    skeleton: RestSkeleton = msgspec.structs.replace(rest(), **damaged)
    path, (frame, *_) = tmp_path / "a.mcap", frames(0.1)
    joints = dict(zip(skeleton.names, frame.joints.values(), strict=True))
    with RecordingWriter(path, RecordingParams(), frame.capture_unix_ns) as writer:
        writer.add_state(skeleton, frame.capture_unix_ns)
        writer.frame(msgspec.structs.replace(frame, joints=joints))
    with pytest.raises(InputError, match="skeleton is none of mocapd"):
        motion_of(RecordingReader(path), 0, None)


def test_a_motion_that_is_too_long_is_refused_with_the_rate_that_fits(tmp_path: Path) -> None:
    first, *_ = frames(0.1)
    day = msgspec.structs.replace(first, capture_unix_ns=first.capture_unix_ns + 86_400 * 10**9)
    reader = RecordingReader(record(tmp_path / "a.mcap", [first, day]))
    with pytest.raises(InputError, match=r"2 h 46 min 40 s at 1000 Hz -- .*115\.74 Hz or less"):
        motion_of(reader, 0, 1000.0)


@pytest.mark.parametrize("up", [1.0, -1.0])
def test_angles_of_a_limb_straight_up_or_down(up: float) -> None:
    R = rotations.to_matrix(rotations.exp(np.array([up * np.pi / 2, 0.0, 0.0])))
    turn = rotations.to_matrix(rotations.exp(np.array([0.0, 0.7, 0.0])))
    z, x, y = np.radians(zxy_degrees(R @ turn))
    again = (
        rotations.to_matrix(rotations.exp(np.array([0.0, 0.0, z])))
        @ rotations.to_matrix(rotations.exp(np.array([x, 0.0, 0.0])))
        @ rotations.to_matrix(rotations.exp(np.array([0.0, y, 0.0])))
    )
    assert np.abs(again - R @ turn).max() < 1e-7


def test_where_nothing_can_be_written_it_is_named(tmp_path: Path) -> None:
    motion = motion_of(RecordingReader(record(tmp_path / "a.mcap", frames(0.1))), 0, None).motion
    for name in ("bvh", "glb", "csv", "trc", "c3d"):
        with pytest.raises(CannotCreateError):
            write_export(motion, name, tmp_path / "none" / f"a.{name}")


def test_the_command(tmp_path: Path, clean_env: dict[str, str]) -> None:
    path = record(tmp_path / "a.mcap", frames(0.5))
    done = mocapd(clean_env, "export", path, "--to", "glb")
    assert done.code == 0
    assert "30 frames at 60 Hz" in done.err
    assert (tmp_path / "a.glb").read_bytes()[:4] == b"glTF"
    assert mocapd_here(clean_env, "export", path, "--to", "fbx").code == 2


def test_the_command_needs_no_valid_configuration(
    tmp_path: Path, clean_env: dict[str, str]
) -> None:
    path = record(tmp_path / "a.mcap", frames(0.5))
    broken = tmp_path / "config.toml"
    broken.write_text("nonsense = 1\n")
    done = mocapd_here(clean_env | {"MOCAPD_CONFIG": str(broken)}, "export", path, "--to", "glb")
    assert done.code == 0
    assert f"the configuration is left out: {broken}:1" in done.err
    assert (tmp_path / "a.glb").read_bytes()[:4] == b"glTF"
