"""When no camera delivers: coasting by the clock, then lost, and on again as after any gap."""

from itertools import pairwise

import numpy as np
import pytest

from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import standard_skeleton
from mocapd.pipeline.absence import FIRST_NS, LOST_EVERY_NS, Absence
from mocapd.trackers.canned.tracker import CannedTracker
from mocapd.types import BodyState, Frame, FrameSet, Tracking
from tests.pipeline.free_running import PIXELS

SKELETON = standard_skeleton(1.7)
N = len(SKELETON.names)
MS = 1_000_000
BEGIN_NS = 7_000 * MS
DELAY_NS = 40 * MS  # from capture to a body that is about to be sent
PERIOD_NS = 33 * MS


def live(t_ns: int) -> BodyState:
    frame = Frame("a", 0, t_ns, PIXELS)
    return CannedTracker().step(FrameSet(t_ns, {"a": frame}), mean_shape(1.7)).body


def lost(t_ns: int) -> BodyState:
    return BodyState(t_ns, Tracking.LOST, "canned", None, None, np.zeros(N))


def fed(absence: Absence, frames: int = 10, period_ns: int = PERIOD_NS) -> int:
    """Begun, and so many live bodies; when the last of them came."""
    absence.begin(BEGIN_NS)
    now_ns = BEGIN_NS
    for _ in range(frames):
        now_ns += period_ns
        assert absence.next_body(now_ns) is None
        body = live(now_ns - DELAY_NS)
        assert absence.came(body, now_ns) is body
    return now_ns


def told(absence: Absence, from_ns: int, seconds: float) -> list[tuple[int, BodyState]]:
    """Asked every 5 ms: what was told, and when."""
    found = []
    for now_ns in range(from_ns, from_ns + round(seconds * 1000) * MS, 5 * MS):
        body = absence.next_body(now_ns)
        if body is not None:
            found.append((now_ns, body))
    return found


def test_the_last_pose_coasts_and_fades_and_then_nobody_is_known() -> None:
    absence = Absence("canned", N, coast_s=0.5)
    last_ns = fed(absence)
    last = live(last_ns - DELAY_NS)
    found = told(absence, last_ns, 5.0)
    states = [body.tracking for _, body in found]
    coasting = states.count(Tracking.COASTING)
    assert 3 <= coasting <= 5
    assert states == [Tracking.COASTING] * coasting + [Tracking.LOST] * (len(states) - coasting)
    assert last.joints_m is not None
    confidences, uncertainties_m = [1.0], [float(last.uncertainty_m.max())]
    for now_ns, body in found[:coasting]:
        assert body.t_ns - last.t_ns <= 500 * MS
        assert body.t_ns == now_ns - DELAY_NS
        assert body.joints_m is not None
        assert np.array_equal(body.joints_m, last.joints_m)
        assert body.cameras == ()
        confidences.append(float(body.confidence.max()))
        uncertainties_m.append(float(body.uncertainty_m.min()))
    assert confidences == sorted(set(confidences), reverse=True)
    assert confidences[-1] < 0.1
    assert uncertainties_m == sorted(set(uncertainties_m))
    assert uncertainties_m[-1] > 0.1  # almost half a second later a hand may be anywhere near
    nobody = found[coasting:]
    assert len(nobody) == 5  # at once, then once a second
    assert nobody[0][0] - last_ns <= 650 * MS
    assert all(b[0] - a[0] == LOST_EVERY_NS for a, b in pairwise(nobody))
    assert all(body.joints_m is None and not body.confidence.any() for _, body in nobody)
    assert all(np.isinf(body.uncertainty_m).all() for _, body in nobody)


def test_frames_that_still_come_at_their_rate_are_never_missed() -> None:
    for period_ms in (8, 33, 67, 140, 240):
        fed(Absence("canned", N, coast_s=0.5), 30, period_ms * MS)


def test_evidence_counts_and_not_the_last_frame() -> None:
    absence = Absence("canned", N, coast_s=0.5)
    now_ns = fed(absence)
    for _ in range(12):  # 0.4 s without evidence: the tracker coasts by itself
        now_ns += PERIOD_NS
        body = live(now_ns - DELAY_NS)
        absence.came(
            BodyState(
                body.t_ns, Tracking.COASTING, "canned", body.pose, body.joints_m, body.confidence
            ),
            now_ns,
        )
    assert [body.tracking for _, body in told(absence, now_ns, 1.0)] == [Tracking.LOST]


def test_of_an_empty_room_nothing_coasts() -> None:
    absence = Absence("canned", N, coast_s=0.5)
    absence.begin(BEGIN_NS)
    now_ns = BEGIN_NS
    for _ in range(10):
        now_ns += PERIOD_NS
        absence.came(lost(now_ns - DELAY_NS), now_ns)
    found = told(absence, now_ns, 3.0)
    assert [body.tracking for _, body in found] == [Tracking.LOST] * 3


def test_before_the_first_frame_it_is_told_after_a_while_that_nobody_is_known() -> None:
    absence = Absence("canned", N, coast_s=0.5)
    assert absence.next_body(BEGIN_NS) is None  # not begun
    absence.begin(BEGIN_NS)
    found = told(absence, BEGIN_NS, 5.5)
    assert [now_ns for now_ns, _ in found] == [
        BEGIN_NS + FIRST_NS + second * LOST_EVERY_NS for second in range(3)
    ]
    assert all(body.t_ns == now_ns for now_ns, body in found)
    assert all(body.tracker == "canned" for _, body in found)


@pytest.mark.parametrize("late_ns", [0, 200 * MS, 3_000 * MS])
def test_times_never_run_backwards_when_frames_come_again(late_ns: int) -> None:
    absence = Absence("canned", N, coast_s=0.5)
    now_ns = fed(absence)
    times = [body.t_ns for _, body in told(absence, now_ns, 2.0)]
    now_ns += 2_000 * MS
    for _ in range(120):
        now_ns += PERIOD_NS
        times.append(absence.came(live(now_ns - DELAY_NS - late_ns), now_ns).t_ns)
    assert all(a < b for a, b in pairwise(times))
    assert times[-1] == now_ns - DELAY_NS - late_ns  # and soon they are the frames' own again
