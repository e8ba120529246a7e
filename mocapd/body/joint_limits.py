"""How far the joints of a body go, and a soft limit for solvers.

Angles are taken from the T-pose (palms down, the pit of the elbow forwards) in the frame of the
parent bone, split into a twist about the bone and a swing. Positive senses, left side (the right is
its mirror image): about x inward rotation and pronation, about -y forwards, about z upwards. Spine:
about x flexion, about y a turn to the left, about z a lean to the right; the neck alike. Left leg, which
hangs along -y: thigh about -x forwards, about z outwards (abduction), about y outward rotation; knee about
x flexion; foot about -x toes up (dorsiflexion), about y toes outwards, about z eversion.

Sources, degrees, adult men unless said otherwise:
- Boone & Azen 1979 (J. Bone Joint Surg. 61-A:756): shoulder horizontal flexion 141 and extension 45,
  abduction 184, inward rotation 69, outward rotation 104; elbow flexion 143, extension 1; forearm
  pronation 76, supination 82 (standard deviations 3 to 9).
- AAOS 1965, Joint Motion: thoracolumbar flexion 80, extension 25, lateral bending 35, rotation 45;
  the shoulder crosses the body by about 30 beyond hanging (adduction 45 to 50 with the arm in front).
- Ludewig et al. 2009 (J. Bone Joint Surg. 91-A:378) and Kapandji, Physiology of the Joints vol. 1:
  the collar bone rises 30 to 45, sinks 5 to 10, goes 25 forwards and 25 backwards, turns about 30.
- Boone & Azen 1979, men from 20 on: hip flexion 121, extension 12, abduction 41, adduction 26, rotation 44
  both ways; knee flexion 141; ankle plantar flexion 54, dorsiflexion 12; foot inversion 36, eversion 19
  (standard deviations 4 to 6). Roaas & Andersson 1982 (Acta Orthop. Scand. 53:205) agree within 10, with
  adduction 30 and a dorsiflexion of 15. AAOS 1965: hip extension 30, abduction and rotation 45, knee
  hyperextension 10. With the body's weight on the foot dorsiflexion goes to 45 (a deep squat, a lunge:
  Bennell et al. 1998, Aust. J. Physiother. 44:175). The bent knee turns by 30 to 40 (Kapandji, vol. 2).
- Youdas et al. 1992 (Phys. Ther. 72:770): neck at 20 to 29 years, flexion 55 to 65, extension 75 to 85,
  rotation 70 to 75, lateral bending 40 to 48 (standard deviations 6 to 13).
Two standard deviations are added, because a person may be looser than the mean. The upper arm's
range includes what the collar bone gives, as trackers divide the motion between both differently.
"""

from collections.abc import Sequence

import numpy as np

from mocapd.body.joint_limit_kernels import JointLimits
from mocapd.body.skeleton import INDEX
from mocapd.geometry import rotations
from mocapd.types import Floats

X, Y, Z = 0, 1, 2

# left side: twist axis, then (least, greatest) about x, y, z [deg]
_LIMITS_DEG: dict[str, tuple[int, tuple[tuple[float, float], ...]]] = {
    "spine": (Y, ((-30.0, 85.0), (-50.0, 50.0), (-40.0, 40.0))),
    "Shoulder": (X, ((-30.0, 30.0), (-30.0, 30.0), (-15.0, 45.0))),
    # swing: 153 forwards and 58 backwards across the horizontal, 105 up, 105 down. The twist is
    # wider than the 104 + 69 measured in abduction: its neutral point moves with the swing (Codman),
    # and a hand behind the head or the back takes it to these ends
    "UpperArm": (X, ((-140.0, 130.0), (-153.0, 58.0), (-105.0, 105.0))),
    # flexion is about -y when the pit of the elbow looks forwards in the T-pose; skeletons differ in
    # that neutral twist of the upper arm by up to 45 degrees, which tilts the hinge towards z
    "LowerArm": (X, ((-90.0, 90.0), (-155.0, 7.0), (-25.0, 75.0))),
    "neck": (Y, ((-95.0, 75.0), (-88.0, 88.0), (-58.0, 58.0))),
    # a leg that is lifted to the side turns outwards, and its swing has a part about z beyond 45; in deep squats of
    # recorded people, knees apart and the hips tipped back less than the pelvis is, it reaches 125, with a twist of 110.
    # Of 69 000 recorded thighs that swing by less than 30 none turns farther than 36 inwards and 55 outwards
    "UpperLeg": (Y, ((-135.0, 30.0), (-55.0, 110.0), (-35.0, 125.0))),
    # as at the elbow, the neutral twist of the thigh differs between skeletons
    "LowerLeg": (Y, ((-10.0, 155.0), (-35.0, 45.0), (-18.0, 18.0))),
    # recorded feet turn up by 60 and sideways by 45 where the heels are up
    "Foot": (Z, ((-60.0, 66.0), (-45.0, 45.0), (-45.0, 30.0))),
}

_HANGING_TWIST_DEG = {"UpperLeg": (-55.0, 55.0)}  # least and greatest while the bone hardly swings


def limits_of(groups: Sequence[tuple[str, ...]]) -> JointLimits:
    """The limits of an adult for these rotation groups; unknown names are free."""
    axis = np.full(len(groups), -1)
    share = np.ones(len(INDEX))
    lower, upper = np.full((len(groups), 3), -np.inf), np.full((len(groups), 3), np.inf)
    hanging = np.zeros((len(groups), 2))
    for g, names in enumerate(groups):
        for name in names:
            share[INDEX[name]] = 1.0 / len(names)
        first = names[0]
        bone = first.removeprefix("left").removeprefix("right")
        if bone not in _LIMITS_DEG:
            continue
        axis[g], ranges = _LIMITS_DEG[bone]
        low, high = np.radians(np.array(ranges)).T
        twist = np.radians(_HANGING_TWIST_DEG.get(bone, ranges[axis[g]]))
        if first.startswith("right"):  # mirrored in x = 0: turns about y and z change their sign
            low, high = (
                np.array([low[0], -high[1], -high[2]]),
                np.array([high[0], -low[1], -low[2]]),
            )
            twist = twist if axis[g] == X else -twist[::-1]
        lower[g], upper[g], hanging[g] = low, high, twist
    joint = np.array([INDEX[names[0]] for names in groups])
    return JointLimits(axis, joint, share, lower, upper, hanging)


def swing_twist(q_xyzw: Floats, axis: int) -> Floats:
    """Angles (...,3) [rad] of rotations (...,4): the twist at `axis`, the swing's vector elsewhere."""
    q = rotations.canonical(np.asarray(q_xyzw, dtype=float))
    twist = np.zeros_like(q)
    twist[..., axis], twist[..., 3] = q[..., axis], np.maximum(q[..., 3], 1e-12)
    twist = rotations.canonical(twist)
    angles = rotations.log(rotations.multiply(q, rotations.inverse(twist)))
    angles[..., axis] = rotations.log(twist)[..., axis]
    return angles


def from_swing_twist(angles_rad: Floats, axis: int) -> Floats:
    """The inverse of `swing_twist`: rotations (...,4)."""
    swing, twist = np.array(angles_rad, dtype=float), np.zeros_like(angles_rad)
    swing[..., axis], twist[..., axis] = 0.0, angles_rad[..., axis]
    return rotations.canonical(rotations.multiply(rotations.exp(swing), rotations.exp(twist)))
