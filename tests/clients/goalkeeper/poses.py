"""A pose whose every side is told apart."""

from goalkeeper.core.limbs import INDEX, LimbPose
from tests.clients.goalkeeper.test_match import t_pose


def left_hand_up() -> LimbPose:
    """Left arm raised, right arm hanging."""
    pose = t_pose()
    points_m = pose.points_m.copy()
    for side, way in (("left", 1.0), ("right", -1.0)):
        shoulder = points_m[INDEX[f"{side}UpperArm"]].copy()
        for point in ("LowerArm", "Hand", "Tip"):
            out_m = abs(points_m[INDEX[side + point]][0] - shoulder[0])
            points_m[INDEX[side + point]] = shoulder + [0.0, way * out_m, 0.0]
    return LimbPose(points_m, pose.known)
