"""How fast every joint moves. Pure."""

from dataclasses import dataclass

import numpy as np

from mocapd.types import Floats
from mocapd_analysis.differentiator import ACCELERATION, SPEED, derivatives, peak
from mocapd_analysis.session import Flags, Session, segments_of


@dataclass(frozen=True, slots=True, eq=False)
class JointSpeeds:
    """Of all joints (F,J); NaN where the joint is not seen, or seen for too short a time.

    seen (F,J): the tracker had evidence, the joint did not leap, and a speed is known from both sides; peaks and means are
    those of these frames. way_m (J,): how far each joint went, along the smoothed way and not across gaps [m].
    """

    speed_m_s: Floats
    acceleration_m_s2: Floats
    seen: Flags
    way_m: Floats


@dataclass(frozen=True, slots=True)
class Peak:
    """A largest value and when; `at_s` is NaN where there is none."""

    value: float
    at_s: float


EDGE_S = 0.5 * SPEED.window_s
NO_PEAK = Peak(float("nan"), float("nan"))
# No joint of a person is accelerated more, and a tracker is wrong by so much in any frame. One that leaps farther in
# one frame, and is back in the next, did not move.
MOST_ACCELERATION_M_S2 = 400.0
TRACKER_M = 0.05


def speeds_of(session: Session) -> JointSpeeds:
    """Of every joint in every frame; a frame in which a joint is not seen, or leaps, has no part in its speed."""
    is_seen = session.is_seen  # of each joint alone
    known = np.stack([is_seen(name) for name in session.joint_names], axis=1)
    known &= ~leaps(session.times_s, session.joints_m)
    frames, joints = known.shape
    speed, acceleration = np.full((2, frames, joints), np.nan)
    seen, way_m = np.zeros((frames, joints), dtype=bool), np.zeros(joints)
    always = known.all(axis=0)
    groups = [np.flatnonzero(always), *np.flatnonzero(~always)[:, None]]
    for group in groups:
        rows = np.flatnonzero(known[:, group].all(axis=1)) if len(group) else group
        if len(rows) == 0:
            continue
        times_s, at_m = session.times_s[rows], session.joints_m[np.ix_(rows, group)]
        smooth_m, velocity = derivatives(times_s, at_m, SPEED, count=1)
        _, _, second = derivatives(times_s, at_m, ACCELERATION)
        place = np.ix_(rows, group)
        speed[place] = np.linalg.norm(velocity, axis=2)
        acceleration[place] = np.linalg.norm(second, axis=2)
        seen[place] = np.isfinite(speed[place]) & _is_inner(times_s)[:, None]
        way_m[group] = _way_m(times_s, smooth_m)
    return JointSpeeds(speed, acceleration, seen, way_m)


def leaps(times_s: Floats, joints_m: Floats) -> Flags:
    """Single frames (F,J) in which a joint is farther from the line between its neighbours than a person can move."""
    found = np.zeros(joints_m.shape[:2], dtype=bool)
    if len(times_s) < 3:
        return found
    before_s, after_s = np.diff(times_s)[:-1, None], np.diff(times_s)[1:, None]
    share = (before_s / (before_s + after_s))[..., None]
    between_m = (1.0 - share) * joints_m[:-2] + share * joints_m[2:]
    off_m = np.zeros(found.shape)
    off_m[1:-1] = np.linalg.norm(joints_m[1:-1] - between_m, axis=2)
    most_m = TRACKER_M + 0.5 * MOST_ACCELERATION_M_S2 * before_s * after_s
    found[1:-1] = off_m[1:-1] > most_m
    # the neighbours of a frame that leaps are off by half as much
    found[1:-1] &= (off_m[1:-1] >= off_m[:-2]) & (off_m[1:-1] >= off_m[2:])
    return found


def _is_inner(times_s: Floats) -> Flags:
    """Frames (F,) away from where a run begins and ends: with frames on one side only noise looks like speed."""
    inner = np.zeros(len(times_s), dtype=bool)
    for part in segments_of(times_s):
        run_s = times_s[part]
        inner[part] = (run_s >= run_s[0] + EDGE_S) & (run_s <= run_s[-1] - EDGE_S)
    return inner


def highest(times_s: Floats, values: Floats, seen: Flags) -> Peak:
    """The largest of the values (F,) that were seen, between frames too, also where a single one is missing."""
    known = np.flatnonzero(seen & np.isfinite(values))
    if len(known) == 0:
        return NO_PEAK
    known_s, known_values = times_s[known], values[known]
    top = int(known_values.argmax())
    run = next(part for part in segments_of(known_s) if part.start <= top < part.stop)
    at_s, value = peak(known_s[run], known_values[run], top - run.start)
    return Peak(value, at_s)


def _way_m(times_s: Floats, smooth_m: Floats) -> Floats:
    """How far joints (F,J,3) went [m], not across gaps: (J,)."""
    steps_m = np.linalg.norm(np.diff(smooth_m, axis=0), axis=2)
    joined = np.zeros(len(steps_m), dtype=bool)
    for part in segments_of(times_s):
        joined[part.start : part.stop - 1] = True
    total: Floats = np.nansum(steps_m[joined], axis=0)
    return total
