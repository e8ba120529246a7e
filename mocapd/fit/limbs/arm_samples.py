"""One arm cut out of the body model: its joints, and samples of what has a label and of the bare hand."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.model import BodyModel, Shaped
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import LEFT_ARM, LEFT_LEG, LEGS, RIGHT_ARM, RIGHT_LEG, TORSO
from mocapd.fit.limbs.limb_search_kernels import ArmSamples
from mocapd.fit.surface_labels import MAX_LABELS, SurfaceLabels
from mocapd.types import Floats, Ints

SKIN_LABEL = MAX_LABELS - 1  # after the surface's labels


@dataclass(frozen=True, slots=True, eq=False)
class SurfaceSamples:
    """Triangles (S,) of an arm with their vertices (S,3), two bones (S,2) as places in its chain, their weights (S,2),
    and labels (S,)."""

    triangle: Ints
    corners: NDArray[np.int32]
    link: Ints
    weights: Floats
    label: NDArray[np.uint8]


@dataclass(frozen=True, slots=True, eq=False)
class Arm:
    """One arm of the body model: its chain of joints (collar, upper, lower, hand), and samples of what has a label and
    of the bare hand."""

    side: str
    chain: Ints
    labelled: SurfaceSamples
    hand: SurfaceSamples
    others: Ints  # all triangles but this arm's
    is_skin: NDArray[np.bool_]  # of these head and other hand, with a False for none


def arm_of(model: BodyModel, labels: SurfaceLabels, side: str) -> Arm:
    """Cut one arm out of the body model; every third triangle is a sample."""
    mine = model.part == (LEFT_ARM if side == "left" else RIGHT_ARM)
    chain = np.array([INDEX[name] for name in model.space.parts[f"{side}_arm"].joints])
    label = labels.label
    bare = (label == 0) & (model.part != TORSO) & (model.part != LEGS)
    return Arm(
        side, chain, _samples(model, chain, np.flatnonzero(mine & (label > 0))[::3], label),
        _samples(model, chain, np.flatnonzero(mine & bare)[::3], np.full_like(label, SKIN_LABEL)),
        np.flatnonzero(~mine), np.append(bare[~mine], False),
    )  # fmt: skip


def leg_of(model: BodyModel, labels: SurfaceLabels, side: str) -> Arm:
    """Cut one leg out of a whole body: its chain is thigh, shank, foot and toes; nothing of it is bare."""
    mine = model.part == (LEFT_LEG if side == "left" else RIGHT_LEG)
    chain = np.array([INDEX[name] for name in model.space.parts[f"{side}_leg"].joints])
    nothing = np.empty(0, np.int64)
    return Arm(
        side, chain, _samples(model, chain, np.flatnonzero(mine)[::3], labels.label),
        _samples(model, chain, nothing, labels.label), np.flatnonzero(~mine),
        np.zeros(int((~mine).sum()) + 1, np.bool_),
    )  # fmt: skip


def _samples(
    model: BodyModel, chain: Ints, triangle: Ints, label: NDArray[np.uint8]
) -> SurfaceSamples:
    bones, weights = model.triangle_bones[triangle, :2], model.triangle_weights[triangle, :2]
    place = np.zeros(int(model.parents.size), dtype=np.int64)
    place[chain] = np.arange(len(chain))
    weights = np.where(np.isin(bones, chain), weights, 0.0)
    return SurfaceSamples(
        triangle, model.triangles[triangle], place[bones],
        weights / weights.sum(axis=1, keepdims=True), label[triangle],
    )  # fmt: skip


def place_samples(body: Shaped, arm: Arm, of: SurfaceSamples) -> ArmSamples:
    """Samples on a body of this shape, in the T-pose."""
    corners = body.vertices[of.corners]
    normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normals, axis=1)
    normals /= area[:, None]
    return ArmSamples(arm.chain, corners.mean(axis=1), normals, area, of.label, of.link, of.weights)
