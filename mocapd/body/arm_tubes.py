"""Arms as tubes. Girths are means of adults (ANSUR II: biceps, forearm, wrist), 0.004
statures added under cloth."""

import numpy as np

from mocapd.body.areas import ARM_AREAS, FOREARM_END, SHOULDER_END, Area
from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.body.surface import LEFT_ARM, LIMB_COLUMNS, RIGHT_ARM, SKIN, TOP, Tube
from mocapd.types import Floats, Skeleton

# Along the bone: fraction of its length, radius in statures (cloth included, but for the hand).
_UPPER_ARM = np.array([[-0.18, 0.022], [-0.10, 0.034], [0.0, 0.0400], [0.16, 0.0405], [0.30, 0.0375],
                       [0.45, 0.0345], [0.62, 0.0325], [0.80, 0.0305], [0.92, 0.0295]])  # fmt: skip
_FOREARM = np.array([[0.0, 0.0290], [0.10, 0.0290], [0.25, 0.0287], [0.40, 0.0267], [0.55, 0.0240],
                     [0.75, 0.0205], [0.95, 0.0180]])  # fmt: skip
_HAND = np.array([[1.0, 0.0150], [1.15, 0.0190], [1.35, 0.0220], [1.55, 0.0190], [1.72, 0.0080]])

# front and back of the trunk, as far as the arm's tube is on its side of the shoulder joint
_TRUNK_AT = {
    "left": (Area.TORSO_FRONT_UPPER_LEFT, Area.TORSO_BACK_UPPER_LEFT),
    "right": (Area.TORSO_FRONT_UPPER_RIGHT, Area.TORSO_BACK_UPPER_RIGHT),
}


def arm_tube(shape: BodyShape, skeleton: Skeleton, side: str) -> Tube:
    """Upper arm, forearm and hand of one side."""
    girth = shape.factors[6]
    arm, elbow, wrist = (
        skeleton.rest_m[INDEX[side + bone]] for bone in ("UpperArm", "LowerArm", "Hand")
    )
    hand_scale = np.linalg.norm(wrist - elbow) / shape.factors[3]  # hands do not follow the forearm
    centres, radii = [], []
    for t, r in _UPPER_ARM:
        centres.append(arm + t * (elbow - arm))
        radii.append(r * girth)
    for t, r in _FOREARM:
        centres.append(elbow + t * (wrist - elbow))
        radii.append(r * girth)
    direction = (wrist - elbow) / np.linalg.norm(wrist - elbow)
    for t, r in _HAND:
        centres.append(wrist + (t - 1.0) * hand_scale * direction)
        radii.append(r)
    centre = np.array(centres)
    radius = np.array(radii) * shape.stature_m
    flat = np.ones(len(radius))
    flat[-len(_HAND) :] = [0.95, 0.7, 0.5, 0.45, 0.45]  # palms face down: thin in y
    outward = 1.0 if side == "left" else -1.0
    angle = 2 * np.pi * np.arange(LIMB_COLUMNS) / LIMB_COLUMNS * outward  # 0: up; front first
    ring = np.stack([np.zeros_like(angle), np.cos(angle), np.sin(angle) * outward], axis=-1)
    rings = centre[:, None] + radius[:, None, None] * ring[None] * np.stack(
        [np.ones_like(flat), flat, np.ones_like(flat)], -1
    )[:, None]  # fmt: skip
    n_upper, n_fore = len(_UPPER_ARM), len(_FOREARM)
    area = np.zeros((len(radius) - 1, LIMB_COLUMNS), dtype=np.uint8)
    material = np.full(len(radius) - 1, SKIN, dtype=np.uint8)
    shoulder, upper_front, upper_back, fore_front, fore_back, wrist_area = list(Area)[
        ARM_AREAS[side]
    ]
    middle = angle + 0.5 * (angle[1] - angle[0])
    front = np.sin(middle) * outward > 0
    for r in range(n_upper + n_fore - 1):
        material[r] = TOP
        if r < n_upper:
            top = _UPPER_ARM[r + 1, 0] if r + 1 < n_upper else 1.0
            along = 0.5 * (_UPPER_ARM[r, 0] + top)
            if along < 0.0:  # the shirt's sleeve begins at the shoulder joint's plane
                area[r] = np.where(front, *_TRUNK_AT[side])
            elif along < SHOULDER_END:
                area[r] = shoulder
            else:
                area[r] = np.where(front, upper_front, upper_back)
        else:
            mid = 0.5 * (_FOREARM[r - n_upper, 0] + _FOREARM[r - n_upper + 1, 0])
            if mid < FOREARM_END:
                area[r] = np.where(front, fore_front, fore_back)
            else:
                area[r] = wrist_area
    weights = _arm_weights(centre, skeleton, side)
    return Tube(
        rings,
        np.repeat(weights[:, None], LIMB_COLUMNS, axis=1),
        area,
        material,
        LEFT_ARM if side == "left" else RIGHT_ARM,
    )


def _arm_weights(centre_m: Floats, skeleton: Skeleton, side: str) -> Floats:
    """Per ring: the upper arm takes over at the shoulder, the forearm at the elbow, the hand at the wrist."""
    x = np.abs(centre_m[:, 0])
    arm, elbow, wrist = (
        abs(skeleton.rest_m[INDEX[side + bone], 0]) for bone in ("UpperArm", "LowerArm", "Hand")
    )
    upper = elbow - arm
    arm_share = np.clip(0.5 + (x - arm) / (0.30 * upper), 0.0, 1.0)
    fore_share = np.clip(0.5 + (x - elbow) / (0.24 * upper), 0.0, 1.0)
    hand_share = np.clip(0.5 + (x - wrist) / (0.12 * upper), 0.0, 1.0)
    weights = np.zeros((len(x), N_JOINTS))
    weights[:, INDEX[side + "Shoulder"]] = 1 - arm_share
    weights[:, INDEX[side + "UpperArm"]] = arm_share * (1 - fore_share)
    weights[:, INDEX[side + "LowerArm"]] = fore_share * (1 - hand_share)
    weights[:, INDEX[side + "Hand"]] = hand_share
    return weights
