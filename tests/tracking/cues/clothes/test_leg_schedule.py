"""Legs below a shirt that carries the trunk: fitted in each frame set while they move, in every second while they stand."""

import numpy as np

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.clock import nanoseconds
from mocapd.fit.fit_params import TICK_S
from mocapd.tracking.cues.clothes.leg_schedule import CameraTurns, LegSchedule
from mocapd.tracking.ticks import TickClock

STANDING_M = np.tile(np.arange(3.0), (N_JOINTS, 1))


def fitted_at(
    foot_m_s: float, every: int = 1, crossing: bool = True, ticks: int = 12, late: bool = False
) -> list[int]:
    """At which ticks legs are fitted of which one foot moves at this speed; late: each frame set waits for the tracker."""
    schedule, out = LegSchedule(), []
    for now in range(ticks):
        if not schedule.rests(now, every, late):
            joints_m = STANDING_M.copy()
            joints_m[INDEX["leftFoot"], 0] += foot_m_s * now * TICK_S
            schedule.on_fit(joints_m, now, nanoseconds(now * TICK_S), crossing)
            out.append(now)
    return out


def test_legs_that_stand_rest_in_every_second_frame_set_and_a_kick_is_followed_in_each() -> None:
    assert fitted_at(2.0) == list(range(12))
    assert np.diff(fitted_at(0.1)).max() == 2
    assert np.diff(fitted_at(0.1))[1:].min() == 2
    assert np.diff(fitted_at(0.1, every=2))[2:].min() == 3


def test_legs_of_a_tracker_that_is_late_rest_in_no_two_frame_sets_on_end() -> None:
    assert fitted_at(2.0, late=True) == list(range(0, 12, 2))
    assert np.diff(fitted_at(0.1, late=True)).max() == 2
    assert fitted_at(0.1, crossing=False, late=True) == list(range(0, 12, 2))


def test_at_60_hz_legs_are_as_fast_before_they_are_fitted_in_each_frame_set() -> None:
    schedule, clock, fits = LegSchedule(), TickClock(), 0
    for k in range(60):
        now, t_s = clock.pass_to(nanoseconds(k / 60)).last, k / 60
        if not schedule.rests(now, 1):
            joints_m = STANDING_M.copy()
            joints_m[INDEX["leftFoot"], 0] += 0.6 * t_s
            schedule.on_fit(joints_m, now, nanoseconds(t_s), True)
            fits += 1
    assert fits == 60


def test_side_by_side_cameras_fit_legs_that_stand_in_each_frame_set() -> None:
    assert fitted_at(0.1, crossing=False) == list(range(12))


def taken(cameras: int, every: int, most: int, at: range) -> list[list[int]]:
    """The cameras whose turn it is at each of these ticks."""
    turns = CameraTurns()
    return [turns.take(range(cameras), now, every * TICK_S, most) for now in at]


def test_cameras_take_turns_no_more_often_than_asked_and_no_frame_set_has_all_of_the_work() -> None:
    assert taken(2, 3, 1, range(7)) == [[0], [1], [], [0], [1], [], [0]]
    assert taken(4, 3, 2, range(4)) == [[0, 1], [2, 3], [], [0, 1]]
    assert taken(2, 4, 1, range(24)) == [[0], [1], [], []] * 6
    assert [now for now, turn in enumerate(taken(2, 3, 2, range(10))) if turn == [0, 1]] == [
        0,
        3,
        6,
        9,
    ]


def test_legs_that_rest_leave_no_camera_out() -> None:
    assert taken(2, 4, 1, range(0, 24, 2)) == [[0], [1]] * 6
    assert taken(2, 3, 1, range(0, 12, 2)) == [[0], [1]] * 3


def test_work_that_takes_turns_comes_to_each_turn_while_legs_rest() -> None:
    schedule, turns = LegSchedule(), []
    for now in range(12):
        if not schedule.rests(now, 1):
            turns.append(schedule.turn(now) % 2)
            schedule.on_fit(STANDING_M, now, nanoseconds(now * TICK_S), True)
    assert turns.count(0) >= 2
    assert turns.count(1) >= 2
