"""Frames from a change of light until the error is back under 6 cm."""

import math

import numpy as np
import pytest

from mocapd.evaluate.recovery import frame_errors_m, recovery, recovery_frames
from tests.evaluate.tracks import EMPTY, FRAMES, moving_truth, track_of

GOOD, BAD = 0.02, 0.15
CHANGE = 40  # frame


@pytest.mark.parametrize(
    ("errors_m", "frames"),
    [
        ([GOOD] * 20, 0),
        ([BAD] * 4 + [GOOD] * 16, 4),
        ([BAD, BAD, GOOD, BAD, GOOD, GOOD, GOOD, GOOD], 4),  # one good frame is not back
        (
            [GOOD, GOOD, BAD, BAD, GOOD, GOOD, GOOD, GOOD],
            4,
        ),  # counted from the change, not the loss
        ([math.inf, math.inf, GOOD, GOOD, GOOD], 2),  # not tracked is worse than any error
        ([GOOD] * 12 + [BAD] * 3 + [GOOD] * 9, 0),  # too late to be the light's doing
        ([BAD] * 20, math.inf),
        ([BAD] * 6 + [GOOD] * 2, 6),  # to the end of the recording
    ],
)
def test_counting(errors_m: list[float], frames: float) -> None:
    assert recovery_frames(np.array(errors_m)) == frames


@pytest.mark.parametrize(
    ("errors_m", "frames"),
    [
        ([GOOD] * 20, 0),
        ([BAD] * 4 + [GOOD] * 5 + [BAD] + [GOOD] * 10, 10),  # back once is not back for good
        ([GOOD] * 12 + [BAD] * 3 + [GOOD] * 9, 15),
        ([GOOD] * 19 + [BAD], math.inf),
    ],
)
def test_counting_for_good(errors_m: list[float], frames: float) -> None:
    assert recovery_frames(np.array(errors_m), for_good=True) == frames


def test_a_steady_light_needs_no_recovery() -> None:
    truth = moving_truth()
    assert recovery(truth, track_of(truth, BAD)) is None


@pytest.mark.parametrize("bad", [0, 1, 5])
def test_frames_are_counted_from_the_change_of_light(bad: int) -> None:
    truth = moving_truth(light_change_s=CHANGE / 30.0 - 0.01)
    error_m = np.full(FRAMES, GOOD)
    error_m[20:25] = BAD  # before, and so of no account
    error_m[CHANGE : CHANGE + bad] = BAD
    assert recovery(truth, track_of(truth, error_m)) == bad


def test_who_was_hidden_is_found_again_when_under_ten_centimetres() -> None:
    truth = moving_truth(clear_s=CHANGE / 30.0 - 0.01)
    error_m = np.full(FRAMES, 0.08)
    error_m[20 : CHANGE + 7] = BAD
    assert recovery(truth, track_of(truth, error_m)) == 7


def test_a_lost_person_is_an_infinite_error() -> None:
    truth = moving_truth(light_change_s=CHANGE / 30.0)
    keep = [f for f in range(EMPTY, FRAMES) if not CHANGE <= f < CHANGE + 3]
    errors = frame_errors_m(truth, track_of(truth, GOOD, keep))
    assert np.isnan(errors[: EMPTY + 15]).all()  # not scored
    assert np.isinf(errors[CHANGE : CHANGE + 3]).all()
    assert errors[CHANGE + 3] == pytest.approx(GOOD)
    assert recovery(truth, track_of(truth, GOOD, keep)) == 3
