"""A figure of capsules around a skeleton in the T-pose: what viewers of a GLB file show.

Each bone is a rigid capsule from its joint to each child joint; a leaf joint gets a short one. Left is warm, right is cold,
so that a mirrored figure is noticeable.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.types import Floats, Ints, Skeleton

_AROUND, _RINGS = 12, 4  # corners around a capsule, rings of each of its ends
_RADII_M = {
    "hips": 0.085, "spine": 0.11, "chest": 0.115, "upperChest": 0.06, "neck": 0.05, "head": 0.095,
    "Shoulder": 0.05, "UpperArm": 0.045, "LowerArm": 0.035, "Hand": 0.03,
    "UpperLeg": 0.07, "LowerLeg": 0.05, "Foot": 0.04, "Toes": 0.03,
}  # fmt: skip
_TIPS_M = {"head": 0.11, "Hand": 0.10, "Toes": 0.04}  # beyond the last joint
_OF_LENGTH = 0.15  # radius of a bone of another name
_TIP_M = 0.08
_WARM, _COLD, _GREY = (226, 139, 88), (88, 142, 226), (205, 205, 198)


@dataclass(frozen=True, slots=True, eq=False)
class CapsuleFigure:
    """V vertices in the world of the T-pose, T triangles.

    places_m, normals (V,3); joints (V,): the joint of each vertex; colours (V,4): 0..255; triangles (T,3): vertex indices,
    anticlockwise from outside.
    """

    places_m: Floats
    normals: Floats
    joints: Ints
    colours: NDArray[np.uint8]
    triangles: Ints


def capsule_figure(skeleton: Skeleton) -> CapsuleFigure:
    places: list[Floats] = []
    normals: list[Floats] = []
    joints: list[Ints] = []
    colours: list[NDArray[np.uint8]] = []
    triangles: list[Ints] = []
    for joint, name in enumerate(skeleton.names):
        for end_m in _ends(skeleton, joint):
            start_m = skeleton.rest_m[joint]
            radius_m = _by_name(_RADII_M, name) or _OF_LENGTH * float(
                np.linalg.norm(end_m - start_m)
            )
            at, out = _capsule(start_m, end_m, radius_m)
            triangles.append(_capsule_triangles() + len(at) * len(places))
            places.append(at)
            normals.append(out)
            joints.append(np.full(len(at), joint))
            colours.append(np.tile(np.array([*_colour(name), 255], np.uint8), (len(at), 1)))
    return CapsuleFigure(
        np.concatenate(places),
        np.concatenate(normals),
        np.concatenate(joints),
        np.concatenate(colours),
        np.concatenate(triangles),
    )


def _ends(skeleton: Skeleton, joint: int) -> Floats:
    """End points of a bone's capsules (N,3) [m]."""
    below: Floats = skeleton.rest_m[skeleton.parents == joint]
    if len(below):
        return below
    parent = int(skeleton.parents[joint])
    along = skeleton.rest_m[joint] - skeleton.rest_m[parent] if parent >= 0 else np.zeros(3)
    length = float(np.linalg.norm(along))
    along = along / length if length > 1e-6 else np.array([0.0, 1.0, 0.0])
    tip_m = _by_name(_TIPS_M, skeleton.names[joint]) or _TIP_M
    ends: Floats = (skeleton.rest_m[joint] + tip_m * along)[None]
    return ends


def _by_name(table: dict[str, float], name: str) -> float | None:
    return table.get(name.removeprefix("left").removeprefix("right"))


def _colour(name: str) -> tuple[int, int, int]:
    return _WARM if name.startswith("left") else _COLD if name.startswith("right") else _GREY


def _capsule(start_m: Floats, end_m: Floats, radius_m: float) -> tuple[Floats, Floats]:
    """Positions and normals (V,3), ring after ring from the start's pole to the end's."""
    along = end_m - start_m
    length = float(np.linalg.norm(along))
    along = along / length if length > 1e-6 else np.array([0.0, 1.0, 0.0])
    second = np.eye(3)[np.argmin(np.abs(along))]
    second = second - (second @ along) * along
    second /= np.linalg.norm(second)
    third = np.cross(along, second)
    up = np.linspace(-np.pi / 2, np.pi / 2, 2 * _RINGS + 1)
    up = np.insert(up, _RINGS, 0.0)  # the ring in the middle twice: at the start and at the end
    round_rad = np.arange(_AROUND) * (2.0 * np.pi / _AROUND)
    outwards = np.cos(round_rad)[:, None] * second + np.sin(round_rad)[:, None] * third
    normals = np.cos(up)[:, None, None] * outwards + np.sin(up)[:, None, None] * along
    centres = np.where(np.arange(len(up))[:, None] <= _RINGS, start_m, end_m)
    places = centres[:, None] + radius_m * normals
    return places.reshape(-1, 3), normals.reshape(-1, 3)


def _capsule_triangles() -> Ints:
    """Vertex indices (T,3) of a capsule; at a pole, where a ring is a point, one triangle of each quad's two."""
    rings = 2 * _RINGS + 2
    corners = []
    for ring in range(rings - 1):
        for i in range(_AROUND):
            a, b = ring * _AROUND + i, ring * _AROUND + (i + 1) % _AROUND
            c, d = a + _AROUND, b + _AROUND
            if ring < rings - 2:
                corners.append((a, d, c))
            if ring > 0:
                corners.append((a, b, d))
    return np.array(corners)
