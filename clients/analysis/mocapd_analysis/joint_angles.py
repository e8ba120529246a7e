"""Angles at the joints from the joints' places. Pure.

| angle | what [degrees] |
|---|---|
| elbow, knee | flexion: 0 with the limb straight |
| shoulder | the upper arm from the trunk: 0 hanging, 90 held out, 180 overhead |
| hip | the thigh from the trunk: 0 standing, 90 seated |
| lean | the trunk from the vertical |
| twist | the line of the shoulders against that of the hips, about the trunk: positive with the left shoulder behind |

The trunk is the line from the hips' middle to the shoulders' middle. A bone's turn about its own axis, and what the hand
does at the wrist, are not told by the joints' places.
"""

import numpy as np

from mocapd.types import Floats
from mocapd_analysis.session import Session

SIDES = ("left", "right")
# The joints that an angle needs.
_TRUNK = ("leftUpperArm", "rightUpperArm", "leftUpperLeg", "rightUpperLeg")
_NEEDS = {
    "lean": _TRUNK,
    "twist": _TRUNK,
} | {
    f"{side}{angle}": tuple(side + joint for joint in joints)
    for side in SIDES
    for angle, joints in (
        ("Elbow", ("UpperArm", "LowerArm", "Hand")),
        ("Knee", ("UpperLeg", "LowerLeg", "Foot")),
        ("Shoulder", ("UpperArm", "LowerArm")),
        ("Hip", ("UpperLeg", "LowerLeg")),
    )
}


def between_deg(a: Floats, b: Floats) -> Floats:
    """The angle between vectors (...,3), 0..180 [degrees]; exact near 0 and 180."""
    cross = np.linalg.norm(np.cross(a, b), axis=-1)
    angle: Floats = np.degrees(np.arctan2(cross, np.vecdot(a, b)))
    return angle


def angles_of(session: Session) -> dict[str, Floats]:
    """Every angle that the session's joints tell, by name, (F,) [degrees]; NaN where a joint was not seen."""
    found: dict[str, Floats] = {}
    for name, needs in _NEEDS.items():
        joints = needs if needs is _TRUNK or not _is_about_trunk(name) else (*needs, *_TRUNK)
        if session.has(*joints):
            angle = _angle_deg(session, name, needs)
            found[name] = np.where(session.is_seen(*needs), angle, np.nan)
    return found


def _is_about_trunk(name: str) -> bool:
    return name.endswith(("Shoulder", "Hip"))


def _angle_deg(session: Session, name: str, needs: tuple[str, ...]) -> Floats:
    places = [session.positions_m(joint) for joint in needs]
    if needs is _TRUNK:
        up = trunk_up(session)
        if name == "lean":
            return between_deg(up, np.broadcast_to([0.0, 1.0, 0.0], up.shape))
        left_arm, right_arm, left_leg, right_leg = places
        return _twist_deg(up, left_arm - right_arm, left_leg - right_leg)
    if _is_about_trunk(name):
        return between_deg(places[1] - places[0], -trunk_up(session))
    return between_deg(places[1] - places[0], places[2] - places[1])


def trunk_up(session: Session) -> Floats:
    """From the hips' middle to the shoulders' (F,3) [m]."""
    left_arm, right_arm, left_leg, right_leg = (session.positions_m(joint) for joint in _TRUNK)
    up: Floats = 0.5 * (left_arm + right_arm - left_leg - right_leg)
    return up


def has_trunk(session: Session) -> bool:
    """Whether the joints that make up the trunk are there."""
    return session.has(*_TRUNK)


def _twist_deg(up: Floats, shoulders: Floats, hips: Floats) -> Floats:
    """Signed angle about `up` from the hips' line to the shoulders' line (F,) [degrees]."""
    length = np.linalg.norm(up, axis=1, keepdims=True)
    axis = up / np.maximum(length, 1e-9)
    flat_shoulders = shoulders - axis * np.vecdot(shoulders, axis)[:, None]
    flat_hips = hips - axis * np.vecdot(hips, axis)[:, None]
    sine = np.vecdot(np.cross(flat_hips, flat_shoulders), axis)
    angle: Floats = np.degrees(np.arctan2(sine, np.vecdot(flat_hips, flat_shoulders)))
    return angle
