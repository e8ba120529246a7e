"""A machine that sleeps: told once, with how long."""

from mocapd.capture.camera_thread.suspension import SuspensionWatch
from mocapd.clock import NS_PER_S, suspended_ns


def test_a_sleep_is_told_once_and_the_jitter_of_two_clocks_is_none() -> None:
    slept_ns = [5 * NS_PER_S]
    watch = SuspensionWatch(lambda: slept_ns[0])
    assert watch.slept_s() == 0.0
    slept_ns[0] += 1_000
    assert watch.slept_s() == 0.0
    slept_ns[0] += 3600 * NS_PER_S
    assert round(watch.slept_s()) == 3600
    assert watch.slept_s() == 0.0


def test_this_machine_has_not_slept_meanwhile() -> None:
    watch = SuspensionWatch()
    assert watch.slept_s() == 0.0
    assert suspended_ns() >= -1_000_000
