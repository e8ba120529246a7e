"""The effort of a machine that is too slow: it falls soon, settles, and comes back when there is room."""

from collections.abc import Callable, Mapping
from itertools import pairwise

from mocapd.clock import nanoseconds
from mocapd.pipeline.effort_control import EffortControl
from mocapd.tracking.effort import Effort

FULL, SAVING, LEAST = Effort

Changes = list[tuple[float, Effort]]


def changes(
    step_s: Callable[[float, Effort], float], lasts_s: float, period_s: float = 1.0 / 30.0
) -> tuple[Changes, float]:
    """When a simulated loop changes its effort [s], and the longest time from a frame set's arrival to the end of its
    step [s]: frame sets arrive each period_s, the newest wins. step_s: how long a step takes, by time and effort."""
    control = EffortControl()
    now_s, done, out, worst_s = 0.0, 0, [], 0.0
    while now_s < lasts_s:
        newest = max(done + 1, int(now_s / period_s))
        arrived_s = newest * period_s
        began_s = max(now_s, arrived_s)
        before = control.effort
        now_s = began_s + step_s(began_s, before)
        done, worst_s = newest, max(worst_s, now_s - arrived_s)
        after = control.update(
            nanoseconds(arrived_s), newest, nanoseconds(now_s - began_s), nanoseconds(now_s)
        )
        if after is not before:
            out.append((now_s, after))
    return out, worst_s


def machine(by_effort: Mapping[Effort, float]) -> Callable[[float, Effort], float]:
    return lambda _, effort: by_effort[effort]


# a third of the steps is longer, as where other poses are tried
def uneven(full_s: float, at_s: float) -> float:
    return full_s * (1.6 if int(at_s * 30.0) % 3 == 0 else 0.7)


def test_a_machine_that_is_quick_enough_does_all_of_the_work() -> None:
    found, _ = changes(lambda at_s, _: uneven(0.025, at_s), 60.0)
    assert found == []


def test_a_machine_half_as_fast_settles_on_one_effort_within_four_seconds() -> None:
    slow = {FULL: 0.050, SAVING: 0.036, LEAST: 0.027}
    found, worst_s = changes(machine(slow), 60.0)
    assert [effort for _, effort in found] == [SAVING, LEAST]
    assert found[-1][0] < 4.0
    assert worst_s < 0.05 + 1.0 / 30.0  # the newest frame set wins: nothing piles up


def test_where_saving_is_enough_least_is_not_tried() -> None:
    found, _ = changes(machine({FULL: 0.040, SAVING: 0.028, LEAST: 0.020}), 60.0)
    assert [effort for _, effort in found] == [SAVING]
    assert found[0][0] < 2.0


def test_a_short_hiccup_changes_nothing() -> None:
    def step_s(at_s: float, _: Effort) -> float:
        return 0.4 if 10.0 <= at_s < 10.034 else 0.027

    assert changes(step_s, 60.0)[0] == []


def test_steps_that_are_quick_on_average_but_skip_frame_sets_are_too_slow() -> None:
    def step_s(at_s: float, effort: Effort) -> float:
        tries = int(at_s * 30.0) % 6 == 0 and effort is FULL
        return 0.075 if tries else 0.018

    found, _ = changes(step_s, 30.0)
    assert [effort for _, effort in found][:1] == [SAVING]


def test_room_for_more_is_used_after_a_while() -> None:
    def step_s(at_s: float, effort: Effort) -> float:
        busy = 3.0 if at_s < 4.0 else 1.0  # another program, which then ends
        return busy * {FULL: 0.020, SAVING: 0.015, LEAST: 0.012}[effort]

    found, _ = changes(step_s, 60.0)
    efforts = [effort for _, effort in found]
    assert efforts == [SAVING, LEAST, SAVING, FULL]
    assert found[2][0] > 8.0  # not at once
    assert found[3][0] < 16.0


def test_full_effort_comes_back_after_a_loaded_start_also_where_it_fills_most_of_the_time() -> None:
    def step_s(at_s: float, effort: Effort) -> float:
        return (2.0 if at_s < 1.5 else 1.0) * {FULL: 0.026, SAVING: 0.021, LEAST: 0.017}[effort]

    found, _ = changes(step_s, 60.0)
    assert [effort for _, effort in found] == [SAVING, FULL]
    assert found[-1][0] < 12.0


def test_more_work_that_failed_is_not_tried_again_soon() -> None:
    # saving leaves room, and full is too much: the load alone does not show that
    found, _ = changes(machine({FULL: 0.040, SAVING: 0.017, LEAST: 0.015}), 600.0)
    tried_s = [at_s for at_s, effort in found if effort is FULL]
    assert [effort for _, effort in found] == [SAVING] + [FULL, SAVING] * len(tried_s)
    waits_s = [b - a for a, b in pairwise(tried_s)]
    assert 2 <= len(tried_s) <= 5
    assert min(waits_s) > 60.0
    assert waits_s == sorted(waits_s)


def test_a_pause_of_the_cameras_is_no_load() -> None:
    control = EffortControl()
    for k in range(40):  # one frame set in two seconds, each step longer than a usual period
        t_ns = nanoseconds(2.0 * k)
        control.update(t_ns, k + 1, nanoseconds(0.2), t_ns + nanoseconds(0.2))
    assert control.effort is FULL


def test_quicker_cameras_need_quicker_steps() -> None:
    step = machine({FULL: 0.022, SAVING: 0.014, LEAST: 0.010})
    assert changes(step, 30.0, 1.0 / 30.0)[0] == []
    assert [effort for _, effort in changes(step, 30.0, 1.0 / 60.0)[0]] == [SAVING]


def test_where_the_least_effort_leaves_room_more_is_tried_once_in_a_minute() -> None:
    found, _ = changes(machine({FULL: 0.050, SAVING: 0.036, LEAST: 0.017}), 60.0)
    assert [effort for _, effort in found] == [SAVING, LEAST, SAVING, LEAST]
    assert found[-1][0] < 12.0
