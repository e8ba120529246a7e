"""A bumped camera is told within five seconds; a person who is half hidden is not a bumped camera."""

from collections.abc import Callable

import numpy as np

from mocapd.calibrate.bump_watch import BumpWatch, Mounting, Residual
from mocapd.clock import nanoseconds

RATE_HZ = 30.0
NAMES = ("left", "right")


def play(
    watch: BumpWatch,
    seconds_s: float,
    start_s: float = 0.0,
    shift: tuple[tuple[float, float], tuple[float, float]] | None = None,
    hidden: Callable[[float, str], bool] | None = None,
    seed: int = 0,
    until_bumped: bool = False,
) -> float:
    """Residuals of a moving person; returns when a camera first was bumped, or the end [s]."""
    rng = np.random.default_rng(seed)
    sway = np.zeros((2, 2))
    for i in range(int(seconds_s * RATE_HZ)):
        t_s = start_s + i / RATE_HZ
        # errors of a fit last over several frames
        sway = 0.9 * sway + rng.normal(0.0, 0.25, (2, 2))
        residuals = {}
        for k, name in enumerate(NAMES):
            away = np.zeros(2) if shift is None else np.asarray(shift[k])
            support = 1500.0
            if hidden is not None and hidden(t_s, name):
                support, away = 500.0, away + np.array([6.0, -4.0])
            residuals[name] = Residual(np.array([0.3, -0.2]) + away + sway[k], support)
        watch.step(nanoseconds(t_s), residuals)
        if until_bumped and watch.bumped:
            return t_s
    return start_s + seconds_s


def test_a_steady_rig_gives_no_alarm_in_five_minutes() -> None:
    watch = BumpWatch(NAMES)
    for minute in range(5):
        play(watch, 60.0, 60.0 * minute, seed=minute)
        assert not watch.bumped


def test_a_bump_is_told_within_five_seconds_and_the_worse_camera_is_named_first() -> None:
    watch = BumpWatch(NAMES)
    play(watch, 10.0)
    # the fit takes up part of a turn of the right camera by bending to both
    told_s = play(watch, 8.0, 10.0, shift=((-2.0, 1.0), (4.0, -2.5)), until_bumped=True, seed=1)
    assert told_s - 10.0 <= 5.0
    play(watch, 3.0, told_s, shift=((-2.0, 1.0), (4.0, -2.5)), seed=2)
    assert watch.bumped[0] == "right"


def test_someone_hidden_behind_a_chair_for_long_is_no_bump() -> None:
    watch = BumpWatch(NAMES)
    play(watch, 10.0)
    play(watch, 20.0, 10.0, hidden=lambda t_s, name: name == "left", seed=1)
    assert not watch.bumped


def test_passing_trouble_is_no_bump() -> None:
    watch = BumpWatch(NAMES)
    play(watch, 10.0)
    rng = np.random.default_rng(0)
    for i in range(900):
        t_s = 10.0 + i / RATE_HZ
        # half a second of nonsense every three seconds, with all pixels confirmed
        wild = rng.normal(0.0, 10.0, 2) if i % 90 < 15 else np.zeros(2)
        watch.step(nanoseconds(t_s), {name: Residual(wild, 1500.0) for name in NAMES})
        assert not watch.bumped


def test_nothing_is_claimed_before_what_is_usual_is_known_and_a_reset_learns_it_again() -> None:
    watch = BumpWatch(NAMES)
    residual = {name: Residual(np.array([5.0, 5.0]), 1500.0) for name in NAMES}
    assert set(watch.step(0, residual).values()) == {Mounting.UNKNOWN}
    play(watch, 10.0, 1.0)
    play(watch, 6.0, 11.0, shift=((0.0, 0.0), (5.0, 0.0)))
    assert watch.bumped == ("right",)
    watch.reset()
    play(watch, 8.0, 17.0, shift=((0.0, 0.0), (5.0, 0.0)))
    assert not watch.bumped


def test_a_camera_put_back_is_steady_again() -> None:
    watch = BumpWatch(NAMES)
    play(watch, 10.0)
    play(watch, 6.0, 10.0, shift=((5.0, 0.0), (0.0, 0.0)))
    assert watch.bumped == ("left",)
    play(watch, 6.0, 16.0)
    assert not watch.bumped
