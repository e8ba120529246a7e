"""Sessions of files: what is read, and what is refused or left out, in words."""

from pathlib import Path

import msgspec
import numpy as np
import pytest

from mocapd.body.bones import NAMES
from mocapd.errors import InputError
from mocapd_analysis.measures import measure
from mocapd_analysis.session_files import checked_session, read_session
from tests.clients.analysis.motions import standing, times, turning_arm
from tests.outputs import recorded

T = times(2.0, 30.0)


def track(path: Path, **changed: object) -> Path:
    joints_m = turning_arm(T, "left", 1.0 + np.sin(3.0 * T))
    fields: dict[str, object] = {
        "times": T + 0.5,
        "joint_names": np.array(NAMES),
        "joints": joints_m,
        "global_quats": np.tile([0.0, 0.0, 0.0, 1.0], (len(T), len(NAMES), 1)),
        "confidence": np.ones(joints_m.shape[:2]),
        "tracker": np.array(["shirt"] * len(T)),
    }
    fields |= changed
    np.savez_compressed(path, **{k: v for k, v in fields.items() if v is not None})  # type: ignore[arg-type]
    return path


def test_a_recording_is_read_as_it_was_recorded(tmp_path: Path) -> None:
    path = recorded.record(tmp_path / "training.mcap", recorded.frames(2.0))
    session = read_session(path)
    assert session.name == "training"
    assert session.joint_names == NAMES
    assert session.rate_hz == pytest.approx(60.0, rel=0.01)
    truth = recorded.moving_body(1.0).joints_m
    assert truth is not None
    assert np.abs(session.joints_m[60] - truth).max() < 1e-3
    assert measure(session).joints["leftHand"].peak_speed.value > 0.3


def test_a_track_is_read(tmp_path: Path) -> None:
    session = read_session(track(tmp_path / "a.npz"))
    assert session.times_s[0] == 0.0
    assert session.has("leftHand", "rightFoot")
    # the legs of this motion never bend, and are told so
    assert any("knees never bend" in note for note in session.notes)
    assert not session.is_seen("leftFoot").any()


def test_a_clock_that_is_set_neither_costs_frames_nor_adds_time(tmp_path: Path) -> None:
    frames = [
        msgspec.structs.replace(one, capture_unix_ns=one.capture_unix_ns - 3600 * 10**9)
        if one.seq >= 60
        else one
        for one in recorded.frames(2.0)
    ]
    session = read_session(recorded.record(tmp_path / "a.mcap", frames))
    assert len(session.times_s) == 120
    assert session.times_s[-1] == pytest.approx(2.0, abs=0.05)
    assert not any("left out" in note for note in session.notes)


def test_a_recording_cut_short_is_read_to_there_and_told(tmp_path: Path) -> None:
    whole = recorded.record(tmp_path / "whole.mcap", recorded.frames(6.0))
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole.read_bytes()[: int(0.6 * whole.stat().st_size)])
    session = read_session(cut)
    assert 1.0 < session.duration_s < 6.0
    assert any("cut short" in note or "not closed" in note for note in session.notes)


@pytest.mark.parametrize(
    "content",
    [b"", b"PK\x03\x04 and nothing else", b"# a text\n" * 50, b"\x89MCAP0\r\n" + bytes(40)],
)
@pytest.mark.parametrize("name", ["a.mcap", "a.npz"])
def test_foreign_files_are_refused_in_one_line(tmp_path: Path, name: str, content: bytes) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.(mcap|npz)") as caught:
        read_session(path)
    assert "\n" not in str(caught.value)


def test_every_cut_of_a_track_is_refused(tmp_path: Path) -> None:
    data = track(tmp_path / "a.npz").read_bytes()
    path = tmp_path / "cut.npz"
    for share in (0.1, 0.5, 0.9, 0.99):
        path.write_bytes(data[: int(share * len(data))])
        with pytest.raises(InputError):
            read_session(path)
    damaged = bytearray(data)
    damaged[len(data) // 3 : len(data) // 3 + 200] = bytes(200)
    path.write_bytes(damaged)
    with pytest.raises(InputError):
        read_session(path)


@pytest.mark.parametrize(
    ("field", "value", "words"),
    [
        ("joints", None, "lacks joints"),
        ("joints", np.zeros((3, 22, 3)), "not of one length"),
        ("joint_names", np.array(["nose"] * 22), "VRM"),
        ("times", np.full(len(T), np.nan), "no frame"),
        ("times", np.array("soon"), "damaged or no track"),
        ("schema", np.array("mocapd.Track.v2"), "schema 'mocapd.Track.v2', not mocapd.Track.v1"),
        ("joints", np.array([{"a": 1}], dtype=object), "damaged or no track"),
    ],
)
def test_what_is_no_track_is_refused(tmp_path: Path, field: str, value: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        read_session(track(tmp_path / "a.npz", **{field: value}))


def test_a_missing_file_and_a_folder_are_refused(tmp_path: Path) -> None:
    for path in (tmp_path / "none.mcap", tmp_path):
        with pytest.raises(InputError, match="no such file"):
            read_session(path)


def test_a_session_without_anybody_is_refused(tmp_path: Path) -> None:
    path = recorded.record(tmp_path / "empty.mcap", [])
    with pytest.raises(InputError):
        read_session(path)
    with pytest.raises(InputError, match="person 3"):
        read_session(recorded.record(tmp_path / "b.mcap", recorded.frames(0.2)), person=3)


def test_frames_that_are_not_finite_or_go_back_are_left_out_and_counted() -> None:
    joints_m, times_s = standing(T), T.copy()
    joints_m[5, 3, 1] = np.nan
    joints_m[6, 0, 0] = 1e12
    times_s[10] = times_s[8]
    times_s[11] = -3.0
    session = checked_session("a", NAMES, times_s, joints_m, np.ones(joints_m.shape[:2]))
    assert len(session.times_s) == len(T) - 4
    assert np.isfinite(session.joints_m).all()
    assert (np.diff(session.times_s) > 0.0).all()
    assert any(note.startswith("2 frames are not finite") for note in session.notes)
    assert any(note.startswith("2 frames are not later") for note in session.notes)


@pytest.mark.filterwarnings("error")
def test_of_knees_that_nobody_saw_it_is_not_said_that_they_never_bend() -> None:
    """As behind a table; nor does numpy warn of them."""
    joints_m = standing(T)
    confidence = np.ones(joints_m.shape[:2])
    confidence[:, [i for i, name in enumerate(NAMES) if name.endswith(("Leg", "Foot", "Toes"))]] = 0
    assert checked_session("a", NAMES, T, joints_m, confidence).notes == ()
