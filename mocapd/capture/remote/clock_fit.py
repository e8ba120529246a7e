"""Estimates offset and drift of a remote clock from NTP-like exchanges. Pure: no clock, no thread.

A request leaves at t0 (our clock), arrives at t1 (remote clock), is answered at t2, and the answer arrives at t3 (Mills,
RFC 5905 §8). Then offset = ((t1 - t0) + (t2 - t3)) / 2 and round trip = (t3 - t0) - (t2 - t1). The error of the offset is
half the difference of both ways: at most half the round trip. So a sample's standard deviation grows with its queueing
delay, the round trip beyond the minimum. A Huber-weighted line through the samples gives offset and drift.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats, Ints

_DRIFT_PRIOR = 1e-4  # quartz of ordinary machines: within 100 ppm
_MOST_DRIFT = 1e-3  # of what is taken for a clock
_NOISE_FLOOR_NS = 30_000.0  # of an answer as fast as the fastest: threads that are woken
_HUBER = 1.5  # [standard deviations]
_ROUNDS = 4  # of reweighting; the weights have converged by then
_LOWEST = 5  # shortest round trips, which give the round trip without queueing


@dataclass(frozen=True, slots=True)
class ClockSample:
    """One question and its answer, all [ns]. local_ns: the middle of question and answer by our clock;
    offset_ns: the other clock minus ours then; round_trip_ns: on the way."""

    local_ns: int
    offset_ns: int
    round_trip_ns: int


@dataclass(frozen=True, slots=True)
class ClockLine:
    """The other clock minus ours: offset_ns at reference_ns of our clock, and drift [s/s].

    uncertainty_ns: one standard deviation at the newest sample. asymmetry_ns: bound of the unobservable error, half the
    shortest round trip.
    """

    reference_ns: int
    offset_ns: int
    drift: float
    uncertainty_ns: float
    asymmetry_ns: float

    def local_from_remote(self, remote_ns: int) -> int:
        """Converts a time of the remote clock to ours [ns]."""
        # subtract the offset first: the drift then acts on a small difference, without loss of digits
        near_ns = remote_ns - self.offset_ns
        return near_ns - round(self.drift / (1.0 + self.drift) * (near_ns - self.reference_ns))

    def remote_from_local(self, local_ns: int) -> int:
        """Converts a time of our clock to the remote one [ns]."""
        return local_ns + self.offset_ns + round(self.drift * (local_ns - self.reference_ns))


def clock_sample(asked_ns: int, taken_ns: int, answered_ns: int, came_ns: int) -> ClockSample:
    """The sample of one exchange: asked_ns and came_ns by our clock, taken_ns and answered_ns by the remote one."""
    return ClockSample(
        local_ns=(asked_ns + came_ns) // 2,
        offset_ns=((taken_ns - asked_ns) + (answered_ns - came_ns)) // 2,
        round_trip_ns=max(0, (came_ns - asked_ns) - (answered_ns - taken_ns)),
    )


def fit_clock(local_ns: Ints, offset_ns: Ints, round_trip_ns: Ints) -> ClockLine:
    """The line through samples (n,), n >= 1, in order of time."""
    reference_ns, base_ns = int(local_ns[-1]), int(np.median(offset_ns))
    t_s = (local_ns - reference_ns) / 1e9
    y_ns = (offset_ns - base_ns).astype(np.float64)
    # queueing may be on either way: the error is uniform within half of it
    waited_ns = round_trip_ns - _without_waiting_ns(round_trip_ns)
    sigma_ns = np.hypot(_NOISE_FLOOR_NS, waited_ns / 2.0 / np.sqrt(3.0))
    weights = np.ones_like(t_s)
    for _ in range(_ROUNDS):
        (at_ns, slope_ns_per_s), variance = _weighted_line(t_s, y_ns, weights / sigma_ns**2)
        off = np.abs(y_ns - at_ns - slope_ns_per_s * t_s) / sigma_ns
        weights = np.minimum(1.0, _HUBER / np.maximum(off, _HUBER))
    return ClockLine(
        reference_ns=reference_ns,
        offset_ns=base_ns + round(at_ns),
        drift=slope_ns_per_s * 1e-9,
        uncertainty_ns=float(np.sqrt(variance)),
        asymmetry_ns=float(round_trip_ns.min()) / 2.0,
    )


def _without_waiting_ns(round_trip_ns: Ints) -> float:
    """Estimates the round trip without queueing, which is shorter than the shortest sample.

    Where each way waits by itself, the k shortest waits rise as sqrt(k), the first of them 0.89 such steps from 0.
    """
    lowest_ns = np.sort(round_trip_ns)[:_LOWEST].astype(np.float64)
    if len(lowest_ns) < 2:
        return 0.0  # no estimate
    first = np.sqrt(np.pi) / 2.0
    step_ns = (lowest_ns[-1] - lowest_ns[0]) / (np.sqrt(len(lowest_ns)) - first)
    return max(0.0, float(lowest_ns[0] - first * step_ns))


def _weighted_line(t_s: Floats, y: Floats, weights: Floats) -> tuple[tuple[float, float], float]:
    """Value at 0 and slope of the line, and the variance of the value; the slope has the prior of a quartz."""
    w, wt = float(weights.sum()), float(weights @ t_s)
    wtt = float(weights @ t_s**2) + (_DRIFT_PRIOR * 1e9) ** -2
    wy, wty = float(weights @ y), float((weights * t_s) @ y)
    determinant = w * wtt - wt**2
    slope = (w * wty - wt * wy) / determinant
    slope = max(-_MOST_DRIFT * 1e9, min(slope, _MOST_DRIFT * 1e9))
    return ((wy - wt * slope) / w, slope), wtt / determinant
