"""The reason why nobody is tracked: told while something as large as a person moves for seconds, and only then."""

import numpy as np
import pytest

from mocapd.clock import nanoseconds
from mocapd.tracking.base import LostReason
from mocapd.tracking.cues.clothes.clothes_params import MotionMonitorParams
from mocapd.tracking.initialisers.motion_monitor import MotionMonitor
from mocapd.types import Bytes
from mocapd.vision.foreground_kernels import BEFORE, SHADOW

LOOKS_S = 0.2


def room(x: int | None, label: int = BEFORE, width: int = 30) -> Bytes:
    """Something 60 px high whose left edge is at x; None: nothing."""
    before = np.zeros((240, 320), np.uint8)
    if x is not None:
        before[100:160, x : x + width] = label
    return before


def reason_after(shown: list[list[Bytes]]) -> LostReason | None:
    """After these looks, each at what every camera shows."""
    monitor = MotionMonitor(MotionMonitorParams())
    for k, pictures in enumerate(shown):
        monitor.update(nanoseconds(LOOKS_S * k), dict(enumerate(pictures)))
    return monitor.reason(nanoseconds(LOOKS_S * len(shown)))


def sways(k: int) -> int:
    return 100 + 3 * (k % 2)


def test_who_moves_for_seconds_and_is_not_found_is_told_of() -> None:
    assert reason_after([[room(sways(k))] * 2 for k in range(16)]) is LostReason.UNRECOGNISED


@pytest.mark.parametrize(
    "shown",
    [
        [[room(None)] * 2 for _ in range(16)],
        [[room(100)] * 2 for _ in range(16)],  # a chair that was moved
        [[room(sways(k))] * 2 for k in range(6)],  # walks in, and is found a moment later
        [[room(sways(k)), room(None)] for k in range(16)],  # in one picture: a curtain
        [[room(sways(k), SHADOW)] * 2 for k in range(16)],
        [[room(sways(k), width=6)] * 2 for k in range(16)],  # a cat
        [[room(sways(k))] * 2 for k in range(16)] + [[room(None)] * 2] * 12,  # has left
    ],
    ids=["nobody", "still", "short", "one camera", "shadow", "small", "gone"],
)
def test_else_nothing_is(shown: list[list[Bytes]]) -> None:
    assert reason_after(shown) is None


def test_who_is_found_leaves_no_reason_behind() -> None:
    monitor = MotionMonitor(MotionMonitorParams())
    for k in range(16):
        monitor.update(nanoseconds(LOOKS_S * k), {0: room(sways(k)), 1: room(sways(k))})
    monitor.reset()
    assert monitor.reason(nanoseconds(3.2)) is None
