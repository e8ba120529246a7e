"""How late cameras are, by how much moves in each of their pictures."""

import numpy as np
import pytest

from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.calibrate.consistency.motion_delay import MotionMeter, MotionSignal, camera_delays
from mocapd.calibrate.consistency.time_judge import CameraTiming, judge_times
from mocapd.types import Floats

HZ = 30.0


def motion(at_s: Floats) -> Floats:
    """Gestures that begin and end: the same for all cameras."""
    rng = np.random.default_rng(3)
    begin = np.cumsum(rng.uniform(0.3, 0.9, 60))
    long = rng.uniform(0.15, 0.4, 60)
    out = np.zeros(len(at_s))
    for b, n in zip(begin, long, strict=True):
        out += np.exp(-0.5 * ((at_s - b) / (0.4 * n)) ** 2)
    return out


def signal(late_s: float, seed: int, seconds: float = 10.0, hz: float = HZ) -> MotionSignal:
    """Of a camera whose pictures are of `late_s` later than their times say."""
    times_s = np.arange(0.0, seconds, 1.0 / hz)
    noise = 0.15 * np.random.default_rng(seed).standard_normal(len(times_s))
    return MotionSignal(times_s, 6.0 + motion(times_s + late_s) + noise)


def timings(*signals: MotionSignal) -> list[CameraTiming]:
    return [CameraTiming(f"cam{k}", one, 1.0 / HZ) for k, one in enumerate(signals)]


def late_findings(cameras: list[CameraTiming]) -> tuple[CaptureFinding, ...]:
    return judge_times(cameras).findings


@pytest.mark.parametrize("frames", [-10.0, -3.0, -1.0, 1.0, 2.5, 6.0, 10.0])
def test_a_delay_is_found_to_a_quarter_of_a_frame(frames: float) -> None:
    [finding] = late_findings(timings(signal(0.0, 1), signal(frames / HZ, 2)))
    assert (finding.mistake, finding.cameras) == (Mistake.DELAY, ("cam1",))
    assert finding.late_s * HZ == pytest.approx(frames, abs=0.25)
    assert finding.is_mended
    assert f"{abs(finding.late_s) * HZ:.1f} frames" in finding.what


def test_of_four_cameras_the_late_one_is_named() -> None:
    [finding] = late_findings(timings(*(signal(0.2 * (k == 2), k) for k in range(4))))
    assert finding.cameras == ("cam2",)
    assert finding.late_s == pytest.approx(0.2, abs=0.01)


def test_cameras_in_step_of_other_rates_or_that_see_other_things_give_no_finding() -> None:
    assert late_findings(timings(signal(0.0, 1), signal(0.0, 2))) == ()
    assert late_findings(timings(signal(0.0, 1), signal(0.0, 2, hz=25.0))) == ()
    noise = MotionSignal(signal(0.0, 1).times_s, np.random.default_rng(9).standard_normal(300))
    assert late_findings(timings(signal(0.0, 1), noise)) == ()
    assert camera_delays([signal(0.0, 1, 1.0), signal(0.0, 2, 1.0)]) == [None, None]


@pytest.mark.parametrize("count", [2, 4])
def test_a_recording_of_another_rate_than_its_times_say_is_named(count: int) -> None:
    slow = signal(0.0, 2, hz=24.0)
    stamped = MotionSignal(np.arange(len(slow.times_s)) / HZ, slow.change)
    right = [signal(0.0, 10 + k) for k in range(count - 1)]
    [finding] = late_findings(timings(*right, stamped))
    assert f"cam{count - 1}" in finding.cameras
    assert count == 2 or len(finding.cameras) == 1
    assert not finding.is_mended
    assert "rate" in finding.what


def test_a_camera_that_sees_something_else_hides_no_delay_of_the_others() -> None:
    other = MotionSignal(signal(0.0, 1).times_s, np.random.default_rng(9).standard_normal(300))
    verdict = judge_times(timings(signal(0.0, 1), other, signal(0.3, 2), signal(0.0, 3)))
    [finding] = verdict.findings
    assert finding.cameras == ("cam2",)
    assert finding.late_s == pytest.approx(0.3, abs=0.01)
    assert verdict.moves_alike == (True, False, True, True)


def test_frames_that_were_dropped_on_the_way_are_not_one_delay() -> None:
    whole = signal(0.0, 2, 14.0)
    kept = np.delete(np.arange(len(whole.times_s)), np.arange(180, 190))
    dropped = MotionSignal(whole.times_s[: len(kept)], whole.change[kept])
    [finding] = late_findings(timings(signal(0.0, 1, 14.0), dropped))
    assert finding.cameras == ("cam1",)
    assert not finding.is_mended
    assert "out of step by 10 frames" in finding.what


def test_somebody_who_stands_still_after_walking_in_is_no_jump() -> None:
    """What a lamp's flicker has in common at another delay is small beside the walk."""
    times_s = np.arange(0.0, 14.0, 1.0 / HZ)
    walks = times_s < 5.0
    flicker = np.random.default_rng(11).standard_normal((3, len(times_s) + 3))
    changes = [
        6.0 + np.where(walks, 3.0 * motion(times_s), 0.1 * (flicker[0, k:][: len(times_s)] + own))
        for k, own in ((0, 0.3 * flicker[1, 3:]), (3, 0.3 * flicker[2, 3:]))
    ]
    assert late_findings(timings(*(MotionSignal(times_s, one) for one in changes))) == ()


def test_the_meter_sees_what_moves() -> None:
    meter, picture = MotionMeter(), np.full((120, 160, 3), 90, np.uint8)
    for k in range(6):
        shown = picture.copy()
        if k == 3:
            shown[40:80, 40:80] = 220
        meter.put(k / HZ, shown)
    change = meter.signal().change
    assert len(change) == 5
    assert min(change[2], change[3]) > max(change[0], change[1], change[4]) + 1.0
