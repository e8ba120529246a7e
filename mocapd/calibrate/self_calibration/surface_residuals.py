"""Non-rigid shape residuals: a body whose surface may differ from the mean body's by a few centimetres locally.

The factors of `body.shape` cannot represent a real body in real cloth. The error is the same in every picture, so
averaging does not remove it, and the camera poses would have to absorb it. So it gets unknowns of its own: smooth
displacements, symmetric between both sides of the body, that move with the bones.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import LEFT_ARM, RIGHT_ARM, TORSO
from mocapd.types import Floats

_TORSO_LEVELS = [0.0, 0.25, 0.5, 0.75, 1.0]  # from hips to neck
_TORSO_BORDERS = [0.0, 0.5, 0.9]  # where borders between patches run about the body
_ALONG_ARM = [0.0, 0.5, 1.0, 1.5, 2.0]  # shoulder 0, elbow 1, wrist 2
_ARM_JOINTS = [0.0, 1.0, 2.0]
_ARM_BORDERS = [0.2, 1.0, 1.9]
_ARM_MIDDLES = [0.5, 1.5]
_X, _Y, _Z = np.eye(3)
_SIDES = ("left", "right")


def free_body(model: BodyModel, off_sd_m: float) -> tuple[BodyModel, Floats]:
    """The model with more shape factors, each of which minus 1 is a displacement [m], and the spread (N,) of every factor
    over people: `off_sd_m` [m] of surface and shoulders (standard deviation)."""
    surface = [*_torso(model), *_arms(model)]
    joints = [np.zeros_like(model.rest_m) for _ in surface]
    for way in (_Y, _Z):
        moved = np.zeros_like(model.rest_m)
        moved[[INDEX[s + b] for s in _SIDES for b in ("UpperArm", "LowerArm", "Hand")]] = way
        joints.append(moved)
        surface.append(_of(model, LEFT_ARM, RIGHT_ARM)[:, None] * way)
    d_vertices = np.concatenate([model.d_vertices, surface])
    free = replace(
        model,
        d_vertices=d_vertices,
        d_rest=np.concatenate([model.d_rest, joints]),
        d_centres=np.ascontiguousarray(d_vertices[:, model.triangles].mean(axis=2)),
    )
    return free, np.concatenate([model.space.factor_sd, np.full(len(surface), off_sd_m)])


def _torso(model: BodyModel) -> list[Floats]:
    """Front and back in and out, the flanks out and forwards, and borders up and down."""
    V, rest = model.vertices_m, model.rest_m
    hips, neck = rest[INDEX["hips"]], rest[INDEX["neck"]]
    level = (V[:, 1] - hips[1]) / (neck[1] - hips[1])
    angle = np.arctan2(V[:, 2] - hips[2] - level * (neck[2] - hips[2]), V[:, 0])  # 0: left side
    torso = _of(model, TORSO)
    front = torso * np.clip(np.sin(angle), 0.0, None) ** 2
    back = torso * np.clip(np.sin(angle), None, 0.0) ** 2
    flank = torso * np.cos(angle) ** 2
    outwards = np.sign(V[:, 0])
    out = []
    for near in _hats(level, _TORSO_LEVELS):
        out += [(where * near)[:, None] * _Z for where in (front, back, flank)]
        out.append((flank * near * outwards)[:, None] * _X)
    for near in _hats(level, _TORSO_BORDERS):
        out += [(where * near)[:, None] * _Y for where in (front, back, flank)]
    return out


def _arms(model: BodyModel) -> list[Floats]:
    """Girth, borders along the arm, its middle line up and forwards, and how the sleeve is turned."""
    V, rest = model.vertices_m, model.rest_m
    arm, elbow, wrist = (rest[INDEX["left" + bone]] for bone in ("UpperArm", "LowerArm", "Hand"))
    along = np.interp(np.abs(V[:, 0]), [arm[0], elbow[0], wrist[0]], _ARM_JOINTS)
    arms = _of(model, LEFT_ARM, RIGHT_ARM)
    outwards = np.sign(V[:, 0])
    from_bone = np.stack([np.zeros(len(V)), V[:, 1] - arm[1], V[:, 2] - arm[2]], axis=1)
    radial = from_bone / np.maximum(np.linalg.norm(from_bone, axis=1, keepdims=True), 1e-9)
    around = np.cross(_X, radial)
    out = [(arms * near)[:, None] * radial for near in _hats(along, _ALONG_ARM)]
    out += [(arms * near * outwards)[:, None] * _X for near in _hats(along, _ARM_BORDERS)]
    for near in _hats(along, _ARM_JOINTS):
        out += [(arms * near)[:, None] * _Y, (arms * near)[:, None] * _Z]
    out += [(arms * near)[:, None] * around for near in _hats(along, _ARM_MIDDLES)]
    return out


def _of(model: BodyModel, *parts: int) -> Floats:
    """(V,) 1 on the vertices of these parts, else 0."""
    out = np.zeros(len(model.vertices_m))
    out[np.unique(model.triangles[np.isin(model.part, parts)])] = 1.0
    return out


def _hats(at: Floats, knots: list[float]) -> NDArray[np.float64]:
    """(K,V): 1 at a knot, falling to 0 at its neighbours; constant beyond the ends."""
    return np.stack([np.interp(at, knots, row) for row in np.eye(len(knots))])
