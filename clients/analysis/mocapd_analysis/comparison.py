"""Two sessions, measure by measure. Pure."""

from dataclasses import dataclass

import numpy as np

from mocapd_analysis.measures import Measures


@dataclass(frozen=True, slots=True)
class Compared:
    """One measure of both; NaN where one of them has none."""

    measure: str
    unit: str
    a: float
    b: float

    @property
    def change_percent(self) -> float:
        """How much more B is than A; NaN where that says nothing."""
        if self.unit == "%" or abs(self.a) < 1e-6:
            return float("nan")
        return 100.0 * (self.b - self.a) / abs(self.a)


def compared(a: Measures, b: Measures) -> tuple[Compared, ...]:
    """What both sessions tell, in the order of the report."""
    ours, theirs = _told(a), _told(b)
    return tuple(
        Compared(measure, unit, value, theirs[measure, unit])
        for (measure, unit), value in ours.items()
        if (measure, unit) in theirs
    )


def _told(found: Measures) -> dict[tuple[str, str], float]:
    told: dict[tuple[str, str], float] = {}
    swing = found.best_swing
    if swing is not None:
        told["peak swing speed", "m/s"] = swing.peak_m_s
        told["mean peak of the swings", "m/s"] = float(np.mean([s.peak_m_s for s in found.swings]))
    told["swings a minute", "1/min"] = _per_minute(found, len(found.swings))
    if found.repetitions is not None:
        told["repetitions", ""] = float(len(found.repetitions.each))
        told["period of a repetition", "s"] = found.repetitions.rhythm.period_s
    for side, reach in found.reaches.items():
        told[f"{side} reach from the shoulder", "m"] = reach.from_shoulder_m
        told[f"{side} space reached", "l"] = reach.volume_l
    for name in ("leftHand", "rightHand", "hips"):
        if name in found.joints:
            told[f"{name} mean speed", "m/s"] = found.joints[name].mean_speed_m_s
    for name, angle in found.angles.items():
        told[f"{name} range", "deg"] = angle.range_deg
        told[f"{name} fastest", "deg/s"] = angle.peak_rate.value
    for pair in found.pairs:
        if pair.measure in ("wrist way", "wrist peak speed"):
            told[f"left over right, {pair.measure}", "%"] = pair.index_percent
    return told


def _per_minute(found: Measures, count: int) -> float:
    """Over the time that was tracked."""
    lost_s = sum(end_s - start_s for start_s, end_s in found.session.gaps_s)
    tracked_s = found.session.duration_s - lost_s
    return 60.0 * count / tracked_s if tracked_s > 1.0 else float("nan")
