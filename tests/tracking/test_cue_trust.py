"""Trust in a cue: hysteresis in quality and in time, at any frame rate."""

from collections.abc import Sequence
from itertools import pairwise

import pytest

from mocapd.tracking.cue_trust import CueTrust, TrustParams

PARAMS = TrustParams(good=0.6, poor=0.4, least_cameras=2, confirm_s=0.5, doubt_s=0.1)
RATES = pytest.mark.parametrize("hz", [15.0, 30.0, 60.0])


def judged(
    spans: Sequence[tuple[float, float | None]], hz: float = 30.0, cameras: int = 2
) -> list[tuple[float, CueTrust]]:
    """With the time [s], after each frame set of these spans: (from when on [s], quality); the last is the end."""
    trust, out = CueTrust(), []
    for (from_s, quality), (to_s, _) in pairwise(spans):
        for k in range(round(from_s * hz), round(to_s * hz)):
            trust = trust.update(round(k * 1e9 / hz), quality, cameras, PARAMS)
            out.append((k / hz, trust))
    return out


def changes_s(of: Sequence[tuple[float, CueTrust]]) -> list[float]:
    """When it began to be believed, no longer, again."""
    believed = [(-1.0, False), *((t_s, trust.trusted) for t_s, trust in of)]
    return [now[0] for last, now in pairwise(believed) if now[1] is not last[1]]


@RATES
def test_good_for_a_while_is_believed_and_poor_for_a_moment_no_more(hz: float) -> None:
    began_s, ended_s = changes_s(judged([(0.0, 0.7), (2.0, 0.3), (4.0, None)], hz))
    assert began_s == pytest.approx(PARAMS.confirm_s, abs=1.01 / hz)
    assert ended_s == pytest.approx(2.0 + PARAMS.doubt_s, abs=1.01 / hz)


@RATES
def test_a_cue_that_finds_no_body_is_doubted_like_a_poor_one(hz: float) -> None:
    _, ended_s = changes_s(judged([(0.0, 0.7), (2.0, None), (4.0, None)], hz))
    assert ended_s == pytest.approx(2.0 + PARAMS.doubt_s, abs=1.01 / hz)


@pytest.mark.parametrize("believed", [True, False])
def test_between_the_limits_nothing_changes(believed: bool) -> None:
    before = [(0.0, 0.7 if believed else 0.3), (1.0, 0.5), (4.0, None)]
    assert judged(before)[-1][1].trusted is believed


def test_one_frame_that_fails_and_a_flash_change_nothing() -> None:
    assert len(changes_s(judged([(0.0, 0.7), (1.0, None), (1.034, 0.7), (2.0, None)]))) == 1
    assert changes_s(judged([(0.0, None), (1.0, 0.7), (1.4, None), (3.0, None)])) == []


def test_with_too_few_cameras_trust_does_not_begin_but_stays() -> None:
    assert changes_s(judged([(0.0, 0.7), (2.0, None)], cameras=1)) == []
    trust = judged([(0.0, 0.7), (1.0, None)])[-1][1]
    for k in range(60):
        trust = trust.update(1_000_000_000 + k * 33_333_333, 0.7, 1, PARAMS)
    assert trust.trusted
    assert not trust.is_good
