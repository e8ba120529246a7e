"""A recording is played in its own time, as if it were now."""

from dataclasses import dataclass, field
from pathlib import Path

import msgspec
import pytest

from mocapd.app.recordings.replay_run import Replay, ReplayParams
from mocapd.clock import NS_PER_S, monotonic_ns, unix_from_monotonic_ns
from mocapd.errors import InputError
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.messages import CalibrationInfo, RestSkeleton, StateMessage
from mocapd.outputs.wire import SkeletonFrame
from tests.cli.mocapd_process import mocapd, mocapd_here
from tests.outputs.recorded import LATENCY_NS, farthest_m, frames, record

PATIENCE_S = 30.0


@dataclass
class Listening:
    """A sink that keeps what comes, and when."""

    name: str = "listening"
    frames: list[SkeletonFrame] = field(default_factory=list)
    states: list[StateMessage] = field(default_factory=list)
    enough: int = 0
    replay: Replay | None = None

    def open(self) -> None:
        """Nothing to open."""

    def send(self, frame: SkeletonFrame) -> None:
        self.frames.append(frame)
        if len(self.frames) == self.enough and self.replay is not None:
            self.replay.end()

    def send_state(self, message: StateMessage) -> None:
        self.states.append(message)

    def status(self) -> SinkStatus:
        return SinkStatus(len(self.frames), 0, 1, "")

    def close(self) -> None:
        """Nothing to close."""


def played(path: Path, params: ReplayParams, enough: int = 0) -> Listening:
    sink = Listening(enough=enough)
    sink.replay = Replay(RecordingReader(path), [sink], "here", params)
    sink.replay.start()
    while not sink.replay.wait(PATIENCE_S):
        pass
    return sink


def test_frames_are_of_now_and_otherwise_as_recorded(tmp_path: Path) -> None:
    recorded = frames(0.3)
    before_ns = monotonic_ns()
    found = played(record(tmp_path / "a.mcap", recorded), ReplayParams())
    after_ns = monotonic_ns()
    assert len(found.frames) == len(recorded)
    assert after_ns - before_ns >= 0.28 * NS_PER_S
    for number, (was, now) in enumerate(zip(recorded, found.frames, strict=True)):
        assert now.seq == number
        assert now.instance == "here"
        assert before_ns <= now.publish_monotonic_ns <= after_ns
        assert now.publish_monotonic_ns - now.capture_monotonic_ns == LATENCY_NS
        offset_ns = now.capture_unix_ns - now.capture_monotonic_ns
        assert abs(offset_ns - unix_from_monotonic_ns()) < NS_PER_S
        assert farthest_m(was, now) < 1e-4
    rest = next(one for one in found.states if isinstance(one, RestSkeleton))
    assert (rest.instance, rest.stature_m) == ("here", 1.75)
    assert any(isinstance(one, CalibrationInfo) for one in found.states)


def test_numbers_and_times_go_on_from_round_to_round(tmp_path: Path) -> None:
    path = record(tmp_path / "a.mcap", frames(0.1))
    found = played(path, ReplayParams(speed=4.0, loop=True), enough=20)
    assert [frame.seq for frame in found.frames][:20] == list(range(20))
    times = [frame.capture_monotonic_ns for frame in found.frames]
    assert times == sorted(times)
    assert found.replay is not None
    assert found.replay.place.rounds == 3


def test_from_a_moment_and_faster(tmp_path: Path) -> None:
    recorded = frames(2.0)
    began_ns = monotonic_ns()
    found = played(record(tmp_path / "a.mcap", recorded), ReplayParams(speed=50.0, from_s=1.5))
    assert monotonic_ns() - began_ns < 20 * NS_PER_S
    assert len(found.frames) == 30
    assert farthest_m(recorded[90], found.frames[0]) < 1e-4
    assert any(isinstance(one, RestSkeleton) for one in found.states)  # told before that moment


def test_a_step_back_of_the_clock_is_no_pause(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    first, *others = frames(0.1)
    jumped = [
        msgspec.structs.replace(one, publish_monotonic_ns=one.publish_monotonic_ns - 3 * NS_PER_S)
        for one in others
    ]
    found = played(record(tmp_path / "a.mcap", [first, *jumped]), ReplayParams(speed=10.0))
    assert len(found.frames) == 6
    assert caplog.messages == ["a step back of the clock of 3 s in the recording is left out"]


def test_beyond_the_end_is_named(tmp_path: Path) -> None:
    path = record(tmp_path / "a.mcap", frames(0.1))
    with pytest.raises(InputError, match=r"ends after 0\.1 s"):
        played(path, ReplayParams(from_s=5.0))


def test_the_command_plays_without_cameras(tmp_path: Path, clean_env: dict[str, str]) -> None:
    path = record(tmp_path / "a.mcap", frames(0.2))
    done = mocapd(
        clean_env, "replay", path, "--output", "osc", "--set", 'osc.destinations=["127.0.0.1:9"]'
    )
    assert (done.code, done.out) == (0, "")
    assert "12 frames sent" in done.err
    wrong = mocapd_here(clean_env, "replay", path, "--output", "smoke")
    assert wrong.code == 2
    assert "one of: zenoh, osc" in wrong.err
