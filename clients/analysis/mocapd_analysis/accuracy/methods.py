"""Ways to differentiate, side by side: ours at several windows and degrees, and what others do."""

from collections.abc import Callable

import numpy as np
from scipy.interpolate import make_interp_spline, make_smoothing_spline
from scipy.signal import butter, sosfiltfilt

from mocapd.types import Floats
from mocapd_analysis.differentiator import SPEED, Smoothing, derivatives

Velocity = Callable[[Floats, Floats], Floats]  # times (F,) [s], places (F,3) [m] to (F,3) [m/s]


def _local(smoothing: Smoothing) -> Velocity:
    return lambda times_s, places_m: derivatives(times_s, places_m, smoothing, count=1)[1]


def _central(times_s: Floats, places_m: Floats) -> Floats:
    return np.asarray(np.gradient(places_m, times_s, axis=0))


def _butterworth(cut_hz: float) -> Velocity:
    """What biomechanics does by custom: second order, there and back, then a spline."""

    def velocity(times_s: Floats, places_m: Floats) -> Floats:
        rate_hz = 1.0 / float(np.median(np.diff(times_s)))
        smooth = sosfiltfilt(butter(2, 2.0 * cut_hz / rate_hz, output="sos"), places_m, axis=0)
        return np.asarray(make_interp_spline(times_s, smooth, k=5).derivative()(times_s))

    return velocity


def _cross_validated(times_s: Floats, places_m: Floats) -> Floats:
    splines = [make_smoothing_spline(times_s, axis) for axis in places_m.T]
    return np.stack([spline.derivative()(times_s) for spline in splines], axis=1)


METHODS: dict[str, Velocity] = {
    "central differences": _central,
    "degree 2, 0.17 s": _local(Smoothing(0.17, 2)),
    "degree 2, 0.27 s": _local(Smoothing(0.27, 2)),
    "degree 4, 0.20 s": _local(Smoothing(0.2, 4)),
    "degree 4, 0.27 s": _local(Smoothing(0.27, 4)),
    "degree 6, 0.27 s": _local(SPEED),
    "degree 6, 0.40 s": _local(Smoothing(0.4, 6)),
    "Butterworth 6 Hz": _butterworth(6.0),
    "Butterworth 8 Hz": _butterworth(8.0),
    "smoothing spline (GCV)": _cross_validated,
}
CHOSEN = "degree 6, 0.27 s"
