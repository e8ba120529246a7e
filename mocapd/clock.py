"""The one clock: integer nanoseconds of CLOCK_MONOTONIC, and its offset to Unix time."""

import time

NS_PER_S = 1_000_000_000


def monotonic_ns() -> int:
    """Now, CLOCK_MONOTONIC [ns]; the clock that V4L2 stamps buffers with."""
    return time.clock_gettime_ns(time.CLOCK_MONOTONIC)


def suspended_ns() -> int:
    """Time suspended since boot [ns]: CLOCK_BOOTTIME includes suspension, CLOCK_MONOTONIC does not."""
    return time.clock_gettime_ns(time.CLOCK_BOOTTIME) - monotonic_ns()


def unix_from_monotonic_ns() -> int:
    """Offset from monotonic to Unix time [ns]; changes when the wall clock is set."""
    return time.clock_gettime_ns(time.CLOCK_REALTIME) - monotonic_ns()


def seconds(duration_ns: int) -> float:
    """A duration in [s]."""
    return duration_ns / NS_PER_S


def nanoseconds(duration_s: float) -> int:
    """A duration in [ns]."""
    return round(duration_s * NS_PER_S)
