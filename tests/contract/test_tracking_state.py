"""Live, coasting, lost: in seconds, whatever the frame rate."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.errors import ConfigError
from mocapd.tracking.tracking_state import TrackingState, TrackingStateParams
from mocapd.types import Tracking

LIVE, COASTING, LOST = Tracking.LIVE, Tracking.COASTING, Tracking.LOST
MS = 1_000_000


def run(state: TrackingState, evidence: str, hz: float, start_ns: int = 0) -> list[Tracking]:
    """`x` is a frame with evidence, `.` one without."""
    step_ns = round(1e9 / hz)
    return [state.step(start_ns + k * step_ns, e == "x") for k, e in enumerate(evidence)]


def test_a_person_who_comes_is_live_within_five_frames_and_not_at_the_first() -> None:
    states = run(TrackingState(), "...xxxxxx", 30.0)
    assert states[:4] == [LOST] * 4
    assert states.index(LIVE) <= 3 + 5 - 1


def test_a_flash_of_evidence_is_no_person() -> None:
    assert set(run(TrackingState(), "..x....x.....x...", 30.0)) == {LOST}


def test_evidence_that_ends_coasts_then_is_lost_by_the_clock() -> None:
    for hz in (15.0, 30.0, 60.0):
        state = TrackingState()
        n = round(hz)
        states = run(state, "x" * n + "." * n, hz)
        assert states[n - 1] is LIVE
        after = states[n:]
        coasting_s = after.count(COASTING) / hz
        assert coasting_s == pytest.approx(0.5, abs=1.01 / hz)
        assert after == [COASTING] * after.count(COASTING) + [LOST] * after.count(LOST)


def test_evidence_during_coasting_is_live_at_once() -> None:
    assert run(TrackingState(), "xxxxx...x", 30.0)[-4:] == [COASTING] * 3 + [LIVE]


def test_return_from_lost_within_five_frames() -> None:
    states = run(TrackingState(), "xxxxx" + "." * 20 + "xxxxx", 30.0)
    assert states[24] is LOST
    assert LIVE in states[25:]


def test_a_pause_without_any_frame_ends_what_was() -> None:
    state = TrackingState()
    run(state, "xxxxx", 30.0)
    assert state.step(3_000 * MS, evidence=True) is LOST
    assert state.step(3_080 * MS, evidence=True) is LIVE


def test_reset_forgets() -> None:
    state = TrackingState()
    run(state, "xxxxx", 30.0)
    state.reset()
    assert state.now is LOST
    assert state.step(200 * MS, evidence=True) is LOST


def test_without_confirmation_the_first_evidence_is_believed() -> None:
    state = TrackingState(TrackingStateParams(confirm_s=0.0))
    assert run(state, ".x.x", 30.0) == [LOST, LIVE, COASTING, LIVE]


@given(st.lists(st.tuples(st.integers(1, 300), st.booleans()), max_size=60))
def test_live_exactly_with_evidence_and_never_coasting_longer_than_allowed(
    steps: list[tuple[int, bool]],
) -> None:
    state = TrackingState()
    t_ns, last_evidence_ns = 0, None
    for step_ms, evidence in steps:
        t_ns += step_ms * MS
        now = state.step(t_ns, evidence)
        if evidence:
            last_evidence_ns = t_ns
            assert now is not COASTING
        else:
            assert now is not LIVE
        if now is COASTING:
            assert last_evidence_ns is not None
            assert t_ns - last_evidence_ns <= 500 * MS


def test_params_that_make_no_sense_are_refused() -> None:
    with pytest.raises(ConfigError, match="coast_s"):
        TrackingStateParams(coast_s=-1.0)
