"""How fast every joint moves. Pure."""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats
from mocapd_analysis.differentiator import ACCELERATION, SPEED, derivatives, peak
from mocapd_analysis.session import Flags, Session


@dataclass(frozen=True, slots=True, eq=False)
class JointSpeeds:
    """Of all joints (F,J); NaN where a run without gaps is too short.

    seen (F,J): the tracker had evidence, and a speed is known from both sides; peaks and means are those of these frames.
    """

    speed_m_s: Floats
    acceleration_m_s2: Floats
    seen: Flags


@dataclass(frozen=True, slots=True)
class Peak:
    """A largest value and when; `at_s` is NaN where there is none."""

    value: float
    at_s: float


EDGE_S = 0.5 * SPEED.window_s
NO_PEAK = Peak(float("nan"), float("nan"))


def speeds_of(session: Session) -> JointSpeeds:
    """Of every joint in every frame."""
    _, velocity = derivatives(session.times_s, session.joints_m, SPEED, count=1)
    _, _, acceleration = derivatives(session.times_s, session.joints_m, ACCELERATION)
    speed: Floats = np.linalg.norm(velocity, axis=2)
    is_seen = session.is_seen  # of each joint alone
    seen = np.stack([is_seen(name) for name in session.joint_names], axis=1)
    return JointSpeeds(
        speed,
        np.linalg.norm(acceleration, axis=2),
        seen & np.isfinite(speed) & _is_inner(session)[:, None],
    )


def _is_inner(session: Session) -> Flags:
    """Frames (F,) away from where tracking begins and ends: with frames on one side only noise looks like speed."""
    inner = np.zeros(len(session.times_s), dtype=bool)
    for part in session.segments:
        times_s = session.times_s[part]
        inner[part] = (times_s >= times_s[0] + EDGE_S) & (times_s <= times_s[-1] - EDGE_S)
    return inner


def highest(times_s: Floats, values: Floats, seen: Flags) -> Peak:
    """The largest of the values (F,) that were seen, between frames too."""
    usable = np.where(seen & np.isfinite(values), values, -np.inf)
    if not np.isfinite(usable).any():
        return NO_PEAK
    at_s, value = peak(times_s, np.where(np.isfinite(usable), values, np.nan), int(usable.argmax()))
    return Peak(value, at_s)


def path_length_m(session: Session, name: str) -> float:
    """How far a joint went [m], along the smoothed way and not across gaps."""
    smooth, _ = derivatives(session.times_s, session.positions_m(name), SPEED, count=1)
    steps_m = np.linalg.norm(np.diff(smooth, axis=0), axis=1)
    joined = np.zeros(len(steps_m), dtype=bool)
    for part in session.segments:
        joined[part.start : part.stop - 1] = True
    return float(np.nansum(steps_m[joined]))
