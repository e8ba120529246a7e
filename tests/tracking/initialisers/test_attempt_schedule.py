"""When the tracker without a shirt looks for somebody, where a look is cheap and where it takes seconds."""

from mocapd.clock import nanoseconds
from mocapd.tracking.cues.clothes.clothes_params import StartParams
from mocapd.tracking.initialisers.attempt_schedule import AttemptSchedule


def looks(seconds: float, look_s: float) -> list[bool]:
    """Of the frame sets that come at 25 Hz, those that are looked at; each is a look, which takes so long."""
    times, t_s, found = AttemptSchedule(StartParams()), 1.0, []
    while t_s < seconds:
        times.on_frame_set(nanoseconds(t_s))
        found.append(times.is_due(nanoseconds(t_s)))
        if found[-1]:
            times.on_attempt(nanoseconds(t_s), pauses=True)
        t_s += max(0.04, look_s) if found[-1] else 0.04
    return found


def test_it_looks_five_times_a_second() -> None:
    assert 45 <= sum(looks(11.0, 0.02)) <= 55


def test_on_a_slow_machine_others_see_pictures_one_after_the_other_between_two_looks() -> None:
    """As a shirt must be seen for some frames before it is believed."""
    found = looks(400.0, 19.0)
    assert sum(found) >= 15
    between = "".join("x" if one else "." for one in found).strip(".").split("x")
    assert all(len(one) >= 40 for one in between if one)
    assert len([one for one in between if one]) >= sum(found) - 1


def test_a_look_under_way_goes_on_with_every_frame_set() -> None:
    times = AttemptSchedule(StartParams())
    for t_s in (1.0, 1.04, 1.08):
        times.on_frame_set(nanoseconds(t_s))
        assert times.is_due(nanoseconds(t_s))
        times.on_attempt(nanoseconds(t_s), pauses=False)


def test_the_first_frame_set_is_looked_at() -> None:
    assert AttemptSchedule(StartParams()).is_due(5)
