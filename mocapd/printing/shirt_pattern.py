"""The standard shirt as flat cloth: front, back and two sleeves with their patches, in five sizes.

Draft: the shirt lies flat with its sleeves straight out, in the wearer's T-pose, cut along the
armholes. A sleeve is the part beyond the armhole, unfolded at the line along the top of the arm; so
the two edges of every seam are of one length by construction.

The ends of the patches follow `calib/shirt_standard_v1.json` on the mean body of the size's stature
(`calib/body_proportions.json`, which the tracker uses, too): the torso from the hips to the neck joint, the
sleeves by fractions of the upper arm and the forearm. Lengths along the cloth equal lengths along the bones.
"""

from dataclasses import dataclass

import numpy as np

from mocapd.body.shape import mean_shape, skeleton_of
from mocapd.body.skeleton import INDEX
from mocapd.errors import ConfigError
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Floats

SEAM_MM = 10.0
HEM_MM = 30.0
EASE_MM = 60.0  # of the chest: close, for cloth that stretches
_FRONT_NECK_MM, _BACK_NECK_MM = 85.0, 25.0  # depth below the neck joint
_CURVE_STEPS = 64


HalfPlane = tuple[Floats, float]


@dataclass(frozen=True, slots=True)
class ShirtMeasures:
    """A wearer of one size [mm]; `arm_joints`: from shoulder joint to shoulder joint; `armhole` and
    `cuff`: round the finished sleeve; `neck`: width of the neckline."""

    stature: float
    chest: float
    arm_joints: float
    armhole: float
    cuff: float
    neck: float


# Round figures. Chest girths are about the middle of the ranges that EN 13402-3 gives these letters
# (men: S 86-94, M 94-102, L 102-110, XL 110-118, XXL 118-129 cm); statures are typical of adults of
# these sizes. Widths and sleeve girths are graded evenly, as in ready-made knitted shirts; no standard
# gives them.
SIZES = {
    "S": ShirtMeasures(1680, 900, 350, 410, 210, 150),
    "M": ShirtMeasures(1740, 980, 370, 430, 220, 156),
    "L": ShirtMeasures(1800, 1060, 390, 460, 230, 162),
    "XL": ShirtMeasures(1840, 1140, 410, 490, 240, 168),
    "XXL": ShirtMeasures(1880, 1240, 430, 520, 250, 174),
}


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """`index` 1..20 in the standard; `outline` (N,2) to its sewing lines, `cloth` (M,2) on into the
    piece's own allowances [mm]."""

    index: int
    outline: Floats
    cloth: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """One flat piece, its outside towards the reader: x right, y up [mm].

    `outline` (N,2) the sewing line, counter-clockwise; `cut` (N,2) the line to cut, with the
    allowances; `notches` (K,4): from the sewing line
    outwards, one for the front half of the armhole, two for the back; `fold` (2,2) or None: the line
    along the top of the arm.
    """

    name: str
    outline: Floats
    cut: Floats
    patches: tuple[Patch, ...]
    notches: Floats
    fold: Floats | None = None

    @property
    def size_mm(self) -> tuple[float, float]:
        """Width and height of the outline, without allowances."""
        width, height = np.ptp(self.outline, axis=0)
        return float(width), float(height)


@dataclass(frozen=True, slots=True, eq=False)
class _Draft:
    """The wearer's left front quarter from the middle line out: y up from the hips, x to the left."""

    neck_y: float
    tip: Floats  # (2,) top of the armhole
    armpit: Floats  # (2,)
    armhole: Floats  # (N, 2) from the tip to the armpit
    neck_x: float
    upper_arm: float
    forearm: float
    cuff_x: float
    cuff: float


def measures_of(size: str) -> ShirtMeasures:
    """By the letter, in any case. Raises ConfigError for another."""
    try:
        return SIZES[size.upper()]
    except KeyError:
        raise ConfigError(
            f"no size {size!r}", "--size", f"choose one of {', '.join(SIZES)}"
        ) from None


def pieces_of(measures: ShirtMeasures) -> tuple[Piece, Piece, Piece, Piece]:
    """Front, back, left sleeve and right sleeve."""
    draft = _draft(measures)
    return (
        _torso(draft, "torso front", _FRONT_NECK_MM, front=True),
        _torso(draft, "torso back", _BACK_NECK_MM, front=False),
        _sleeve(draft, "left"),
        _sleeve(draft, "right"),
    )


def _draft(measures: ShirtMeasures) -> _Draft:
    rest_mm = skeleton_of(mean_shape(measures.stature / 1000)).rest_m * 1000
    hips, neck, arm, elbow, wrist = (
        rest_mm[INDEX[name]]
        for name in ("hips", "neck", "leftUpperArm", "leftLowerArm", "leftHand")
    )
    upper_arm, forearm = float(elbow[0] - arm[0]), float(wrist[0] - elbow[0])
    joint_x = measures.arm_joints / 2
    # the cloth lies on the arm, a sleeve's radius above its joint
    tip = np.array([joint_x, arm[1] - hips[1] + measures.armhole / (2 * np.pi)])
    armpit = np.array([(measures.chest + EASE_MM) / 4, tip[1] - measures.armhole / 2])
    armhole = _bezier(
        tip,
        tip + 0.6 * np.array([0.0, armpit[1] - tip[1]]),
        armpit - 0.6 * np.array([armpit[0] - tip[0], 0.0]),
        armpit,
    )
    end = standard_shirt().arm_fractions["cuff"][1]
    return _Draft(
        neck_y=float(neck[1] - hips[1]),
        tip=tip,
        armpit=armpit,
        armhole=armhole,
        neck_x=measures.neck / 2,
        upper_arm=upper_arm,
        forearm=forearm,
        cuff_x=joint_x + upper_arm + end * forearm,
        cuff=measures.cuff,
    )


def _torso(draft: _Draft, name: str, neck_depth: float, *, front: bool) -> Piece:
    angle = np.linspace(0.0, np.pi / 2, _CURVE_STEPS)
    neckline = np.column_stack(
        [draft.neck_x * np.cos(angle), draft.neck_y - neck_depth * np.sin(angle)]
    )
    armhole_up = draft.armhole[::-1]
    right_half = np.vstack([[[draft.armpit[0], 0.0]], armhole_up, neckline])
    left_half = right_half[-2::-1] * [-1.0, 1.0]
    outline = np.vstack([right_half, left_half])
    hem = (outline[:, 1] == 0.0) & (np.roll(outline[:, 1], -1) == 0.0)
    cut = offset(outline, np.where(hem, HEM_MM, SEAM_MM))
    upper, lower = _beyond(1, +1, draft.neck_y / 2), _beyond(1, -1, draft.neck_y / 2)
    # viewed from outside, the wearer's left is at the right of the front and at the left of the back
    side, left_sign = ("front", 1) if front else ("back", -1)
    patches = tuple(
        _patch(f"torso_{side}_{level}_{hand}", outline, cut, upright, _beyond(0, sign))
        for level, upright in (("upper", upper), ("lower", lower))
        for hand, sign in (("left", left_sign), ("right", -left_sign))
    )
    notch = _notches(draft.armhole, 1 if front else 2)
    notches = np.vstack([notch, notch * [-1.0, 1.0, -1.0, 1.0]])
    return Piece(name, outline, cut, patches, notches)


def _sleeve(draft: _Draft, hand: str) -> Piece:
    """Its shoulder end up, the outside towards the reader: the front half of the left sleeve is then
    at the left, that of the right sleeve at the right."""
    spans = standard_shirt().arm_fractions
    tip_x, tip_y = draft.tip
    # across the arm from the fold, and down the arm from the shoulder joint
    flat = np.column_stack([tip_y - draft.armhole[:, 1], tip_x - draft.armhole[:, 0]])
    cap_right = flat[::-1]  # from the armpit up to the fold
    cuff = np.array([draft.cuff / 2, tip_x - draft.cuff_x])
    outline = np.vstack([
        [cuff * [-1.0, 1.0], cuff],
        cap_right,
        cap_right[-2::-1] * [-1.0, 1.0],
    ])  # fmt: skip
    hem = (outline[:, 1] == cuff[1]) & (np.roll(outline[:, 1], -1) == cuff[1])
    cut = offset(outline, np.where(hem, HEM_MM, SEAM_MM))
    # where one patch follows another, down the arm
    shoulder_end = -spans["shoulder"][1] * draft.upper_arm
    elbow = -draft.upper_arm
    forearm_end = elbow - spans["forearm"][1] * draft.forearm
    front_sign = -1 if hand == "left" else 1
    front, back = _beyond(0, front_sign), _beyond(0, -front_sign)
    upper_arm = _beyond(1, -1, shoulder_end), _beyond(1, +1, elbow)
    forearm = _beyond(1, -1, elbow), _beyond(1, +1, forearm_end)
    patches = (
        _patch(f"{hand}_shoulder", outline, cut, _beyond(1, +1, shoulder_end)),
        _patch(f"{hand}_upper_arm_front", outline, cut, *upper_arm, front),
        _patch(f"{hand}_upper_arm_back", outline, cut, *upper_arm, back),
        _patch(f"{hand}_forearm_front", outline, cut, *forearm, front),
        _patch(f"{hand}_forearm_back", outline, cut, *forearm, back),
        _patch(f"{hand}_cuff", outline, cut, _beyond(1, -1, forearm_end)),
    )
    # of the cap, whose outside is up: one notch on the front half, two on the back
    cap = cap_right[::-1] * [front_sign, 1.0]
    notches = np.vstack([_notches(cap, 1), _notches(cap * [-1.0, 1.0], 2)])
    fold = np.array([[0.0, 0.0], [0.0, cuff[1]]])
    return Piece(f"{hand} sleeve", outline, cut, patches, notches, fold)


def clip(polygon: Floats, normal: Floats, least: float) -> Floats:
    """The part of the polygon (N,2) where `normal . p >= least` (Sutherland and Hodgman 1974)."""
    height = polygon @ normal - least
    inside: list[Floats] = []
    for i in range(len(polygon)):
        a, b, ha, hb = polygon[i - 1], polygon[i], height[i - 1], height[i]
        if (ha > 0) != (hb > 0) and ha != 0 and hb != 0:
            inside.append(a + (b - a) * ha / (ha - hb))
        if hb >= 0:
            inside.append(b)
    return np.array(inside)


def offset(polygon: Floats, distance: Floats) -> Floats:
    """Each edge of the counter-clockwise polygon (N,2), from vertex i to i + 1, moved outwards by
    distance[i]; corners mitred."""
    edge = np.roll(polygon, -1, axis=0) - polygon
    length = np.linalg.norm(edge, axis=1, keepdims=True)
    normal = np.column_stack([edge[:, 1], -edge[:, 0]]) / length
    moved = np.empty_like(polygon)
    for i in range(len(polygon)):
        N, d = normal[[i - 1, i]], distance[[i - 1, i]]
        # least squares of least norm: exact at a corner, the common offset along a straight line
        moved[i] = polygon[i] + np.linalg.lstsq(N, d, rcond=1e-3)[0]
    return moved


def _notches(curve: Floats, count: int) -> Floats:
    """(count,4) ticks across the curve (N,2), about its middle, 4 mm apart and to either side."""
    step = np.linalg.norm(np.diff(curve, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(step)])
    places = along[-1] / 2 + 4.0 * (np.arange(count) - (count - 1) / 2)
    rows = []
    for place in places:
        at = np.array([np.interp(place, along, curve[:, k]) for k in (0, 1)])
        i = int(np.searchsorted(along, place)) - 1
        direction = (curve[i + 1] - curve[i]) / step[i]
        across = 4.0 * np.array([direction[1], -direction[0]])
        rows.append(np.concatenate([at - across, at + across]))
    return np.array(rows)


def _bezier(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    t = np.linspace(0.0, 1.0, _CURVE_STEPS)[:, None]
    return (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d


def _beyond(axis: int, sign: int, value: float = 0.0) -> HalfPlane:
    """The half plane on this side of x (axis 0) or y (axis 1) = value, as `clip` takes it."""
    normal = np.zeros(2)
    normal[axis] = sign
    return normal, sign * value


def _patch(name: str, outline: Floats, cut: Floats, *borders: HalfPlane) -> Patch:
    cloth = cut
    for normal, least in borders:
        outline, cloth = clip(outline, normal, least), clip(cloth, normal, least)
    return Patch(standard_shirt().patch_names.index(name) + 1, outline, cloth)
