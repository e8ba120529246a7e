"""Everything that is said of one session, from its arrays alone. Pure."""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats
from mocapd_analysis.differentiator import SPEED, derivatives
from mocapd_analysis.joint_angles import SIDES, angles_of
from mocapd_analysis.joint_speeds import JointSpeeds, Peak, highest, speeds_of
from mocapd_analysis.reach import Reach, reaches_of
from mocapd_analysis.repetitions import Repetitions, repetitions_of
from mocapd_analysis.session import Flags, Session
from mocapd_analysis.swings import Swing, swings_of
from mocapd_analysis.symmetry import SidePair, Together, together

# What may count as a repetition: less is swaying, breathing, or the tracker's noise.
LEAST_RANGE = {"m": 0.08, "deg": 12.0}
LEAST_SEEN = 0.05  # share of the frames; a joint that is seen less is left out


@dataclass(frozen=True, slots=True)
class JointSummary:
    """seen: share of frames with evidence, 0..1; the rest over those frames, from from_s to to_s [s]."""

    seen: float
    from_s: float
    to_s: float
    peak_speed: Peak
    mean_speed_m_s: float
    peak_acceleration: Peak
    way_m: float


@dataclass(frozen=True, slots=True)
class AngleSummary:
    """Of one angle [degrees], known from from_s to to_s [s].

    peak_rate: the fastest that it changes [degrees/s], either way.
    """

    from_s: float
    to_s: float
    least_deg: float
    most_deg: float
    mean_deg: float
    peak_rate: Peak

    @property
    def range_deg(self) -> float:
        return self.most_deg - self.least_deg


@dataclass(frozen=True, slots=True, eq=False)
class Measures:
    """One session measured. angles_deg, angle_rates_deg_s: (F,) by name; swings in order of time."""

    session: Session
    speeds: JointSpeeds
    joints: dict[str, JointSummary]
    angles_deg: dict[str, Floats]
    angle_rates_deg_s: dict[str, Floats]
    angles: dict[str, AngleSummary]
    swings: tuple[Swing, ...]
    reaches: dict[str, Reach]
    pairs: tuple[SidePair, ...]
    together: Together | None
    repetitions: Repetitions | None

    @property
    def best_swing(self) -> Swing | None:
        """The fastest."""
        return max(self.swings, key=lambda swing: swing.peak_m_s, default=None)

    def wrist_speed_m_s(self, side: str) -> Floats:
        """(F,) of one wrist, NaN where it is not known; KeyError without that joint."""
        at = self.session.joint(f"{side}Hand")
        speed: Floats = np.where(self.speeds.seen[:, at], self.speeds.speed_m_s[:, at], np.nan)
        return speed


def measure(session: Session) -> Measures:
    """Everything, in one pass over the session."""
    speeds = speeds_of(session)
    joints = {
        name: summary
        for at, name in enumerate(session.joint_names)
        if (summary := _joint_summary(session, speeds, at)).seen >= LEAST_SEEN
    }
    angles_deg, rates_deg_s, angles = _angles(session)
    swings = [
        swing
        for side in SIDES
        if f"{side}Hand" in joints
        for swing in swings_of(
            session,
            side,
            speeds.speed_m_s[:, session.joint(f"{side}Hand")],
            speeds.seen[:, session.joint(f"{side}Hand")],
        )
    ]
    found = Measures(
        session, speeds, joints, angles_deg, rates_deg_s, angles,
        tuple(sorted(swings, key=lambda swing: swing.at_s)),
        reaches_of(session), (), None, None,
    )  # fmt: skip
    return _with_sides_and_repetitions(found)


def _joint_summary(session: Session, speeds: JointSpeeds, at: int) -> JointSummary:
    seen = speeds.seen[:, at]
    speed = speeds.speed_m_s[:, at]
    return JointSummary(
        float(seen.mean()),
        *_span_s(session, seen),
        highest(session.times_s, speed, seen),
        float(speed[seen].mean()) if seen.any() else float("nan"),
        highest(session.times_s, speeds.acceleration_m_s2[:, at], seen),
        float(speeds.way_m[at]),
    )


def _span_s(session: Session, told: Flags) -> tuple[float, float]:
    """The first and the last time of these frames (F,) [s]; NaN without one."""
    at = np.flatnonzero(told)
    if len(at) == 0:
        return float("nan"), float("nan")
    return float(session.times_s[at[0]]), float(session.times_s[at[-1]])


def _angles(
    session: Session,
) -> tuple[dict[str, Floats], dict[str, Floats], dict[str, AngleSummary]]:
    smooth: dict[str, Floats] = {}
    rates: dict[str, Floats] = {}
    summaries: dict[str, AngleSummary] = {}
    for name, raw in angles_of(session).items():
        known = np.isfinite(raw)
        if known.mean() < LEAST_SEEN:
            continue
        # an angle that goes round would jump
        whole = raw if name != "twist" else _unwrapped_deg(raw)
        values, slopes = np.full(len(raw), np.nan), np.full(len(raw), np.nan)
        values[known], slopes[known] = derivatives(
            session.times_s[known], whole[known], SPEED, count=1
        )
        told = np.isfinite(values)
        if not told.any():
            continue
        smooth[name], rates[name] = values, slopes
        summaries[name] = AngleSummary(
            *_span_s(session, told),
            float(np.nanquantile(values, 0.005)),
            float(np.nanquantile(values, 0.995)),
            float(np.nanmean(values)),
            highest(session.times_s, np.abs(slopes), told),
        )
    return smooth, rates, summaries


def _unwrapped_deg(values_deg: Floats) -> Floats:
    out = values_deg.copy()
    known = np.isfinite(out)
    out[known] = np.degrees(np.unwrap(np.radians(out[known])))
    return out


def _with_sides_and_repetitions(found: Measures) -> Measures:
    session = found.session
    both = all(f"{side}Hand" in found.joints for side in SIDES)
    wrists = [found.wrist_speed_m_s(side) for side in SIDES] if both else []
    return Measures(
        session, found.speeds, found.joints, found.angles_deg, found.angle_rates_deg_s,
        found.angles, found.swings, found.reaches,
        tuple(_pairs(found)),
        together(session.times_s, wrists[0], wrists[1]) if both else None,
        repetitions_of(session, _signals(found)),
    )  # fmt: skip


def _pairs(found: Measures) -> list[SidePair]:
    """What both sides have."""
    pairs: list[SidePair] = []

    def add(measure: str, unit: str, values: dict[str, float]) -> None:
        if len(values) == 2 and all(np.isfinite(list(values.values()))):
            pairs.append(SidePair(measure, unit, values["left"], values["right"]))

    def of_joints(name: str) -> dict[str, JointSummary]:
        return {side: found.joints[side + name] for side in SIDES if side + name in found.joints}

    for name, words in (("Hand", "wrist"), ("LowerArm", "elbow"), ("Foot", "ankle")):
        each = of_joints(name)
        add(f"{words} peak speed", "m/s", {s: one.peak_speed.value for s, one in each.items()})
        add(f"{words} mean speed", "m/s", {s: one.mean_speed_m_s for s, one in each.items()})
        add(f"{words} way", "m", {s: one.way_m for s, one in each.items()})
    for name in ("Elbow", "Shoulder", "Knee", "Hip"):
        ranges = {
            side: found.angles[side + name].range_deg
            for side in SIDES
            if side + name in found.angles
        }
        add(f"{name.lower()} range", "deg", ranges)
    reaches = {side: one.from_shoulder_m for side, one in found.reaches.items()}
    add("reach from the shoulder", "m", reaches)
    add("space reached", "l", {side: one.volume_l for side, one in found.reaches.items()})
    return pairs


def _signals(found: Measures) -> dict[str, tuple[str, Floats]]:
    """What repetitions may be counted by: angles, and heights of hips and wrists."""
    signals = {name: ("deg", values) for name, values in found.angles_deg.items()}
    for name in ("hips", "leftHand", "rightHand"):
        if name in found.joints:
            at = found.session.joint(name)
            height = np.where(found.speeds.seen[:, at], found.session.joints_m[:, at, 1], np.nan)
            signals[f"height of {name}"] = ("m", height)
    return {
        name: (unit, values)
        for name, (unit, values) in signals.items()
        if np.nanquantile(values, 0.95) - np.nanquantile(values, 0.05) >= LEAST_RANGE[unit]
    }
