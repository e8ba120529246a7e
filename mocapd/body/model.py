"""The articulated body as flat arrays for the kernels: surface, skin weights, groups, shape derivatives; and the
same in the wearer's proportions."""

from dataclasses import dataclass, field
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import Articulation, SkinArrays, TriangleArrays
from mocapd.body.pose_space import SIDES, PoseSpace, upper_body
from mocapd.body.shape import BodyShape, skeleton_of
from mocapd.body.skeleton import INDEX, PARENTS
from mocapd.body.surface import LEGS, join_tubes
from mocapd.body.surface_building import rough_tubes, shape_derivatives, whole_tubes
from mocapd.types import Floats, Ints

_BONES = 4  # skin weights kept per point
# Hands bend at the wrist, and the model's do not: what their pixels say of a forearm's direction is mostly wrong.
_STIFFNESS_OF_HANDS = 0.2
_HANDS = [INDEX[side + "Hand"] for side in SIDES]


@dataclass(frozen=True, slots=True, eq=False)
class BodyModel:
    """Mean body of one stature. V vertices, T triangles, B bones per point, N shape factors.

    In a space that is not whole the triangles of the legs are left out.
    """

    space: PoseSpace
    stature_m: float
    vertices_m: Floats  # (V,3)
    bones: NDArray[np.int32]  # (V,B)
    weights: Floats  # (V,B)
    triangles: NDArray[np.int32]  # (T,3)
    area: NDArray[np.uint8]  # (T,) an `Area`
    part: NDArray[np.uint8]  # (T,) a part of body.surface
    triangle_bones: NDArray[np.int32]  # (T,B), of the triangle's centre
    triangle_weights: Floats  # (T,B)
    rest_m: Floats  # (J,3)
    d_vertices: Floats  # (N,V,3)
    d_rest: Floats  # (N,J,3)
    centres_m: Floats  # (T,3) of the triangles
    d_centres: Floats  # (N,T,3)
    parents: Ints  # (J,)
    group_of_joint: Ints  # (J,), -1: does not move
    share_of_joint: Floats  # (J,)
    joint_of_group: Ints  # (G,) the first joint of each group
    # the same arrays as the kernels take them
    articulation: Articulation = field(init=False)
    skin: SkinArrays = field(init=False)
    surface: TriangleArrays = field(init=False)

    def __post_init__(self) -> None:
        made = {
            "articulation": Articulation(
                self.parents, self.group_of_joint, self.share_of_joint, self.joint_of_group, self.d_rest
            ),
            "skin": SkinArrays(self.bones, self.weights),
            "surface": TriangleArrays(
                self.triangles, self.triangle_bones, self.triangle_weights, self._stiffness(), self.d_centres
            ),
        }  # fmt: skip
        for name, arrays in made.items():
            object.__setattr__(self, name, arrays)

    def _stiffness(self) -> Floats:
        """(T,), see `TriangleArrays`."""
        is_hand = np.isin(self.triangle_bones[:, 0], _HANDS)
        return np.where(is_hand, _STIFFNESS_OF_HANDS, 1.0)

    @property
    def n_pose(self) -> int:
        """How many numbers a pose has."""
        return self.space.n_pose

    @property
    def n_shape(self) -> int:
        """How many shape factors this model has: those of its space, or more."""
        return len(self.d_rest)


@lru_cache(maxsize=8)  # every part of the program asks for the same few, and each takes 0.1 s
def build_model(stature_m: float, space: PoseSpace | None = None) -> BodyModel:
    """The model of the mean body of this stature; space: `upper_body` unless another is given.

    The same object to whoever asks for the same.
    """
    space = space if space is not None else upper_body()
    make_tubes = whole_tubes if space.whole else rough_tubes
    mean = BodyShape(stature_m, np.ones(space.n_shape))
    surface = join_tubes(make_tubes(mean))
    d_vertices, d_rest = shape_derivatives(stature_m, make_tubes, space.n_shape)
    keep = surface.part != LEGS
    triangles = surface.triangles[keep]
    used = np.unique(triangles)
    renumber = np.full(len(surface.vertices_m), -1)
    renumber[used] = np.arange(len(used))
    triangles = renumber[triangles].astype(np.int32)
    bones, weights = _strongest(surface.weights[used])
    triangle_bones, triangle_weights = _strongest(surface.weights[used][triangles].mean(axis=1))
    return BodyModel(
        space=space,
        stature_m=stature_m,
        vertices_m=surface.vertices_m[used],
        bones=bones,
        weights=weights,
        triangles=triangles,
        area=surface.area[keep],
        part=surface.part[keep],
        triangle_bones=triangle_bones,
        triangle_weights=triangle_weights,
        rest_m=skeleton_of(mean).rest_m,
        d_vertices=np.ascontiguousarray(d_vertices[:, used]),
        d_rest=d_rest,
        centres_m=surface.vertices_m[used][triangles].mean(axis=1),
        d_centres=np.ascontiguousarray(d_vertices[:, used][:, triangles].mean(axis=2)),
        parents=PARENTS,
        group_of_joint=space.group_of_joint,
        share_of_joint=space.share_of_joint,
        joint_of_group=space.joint_of_group,
    )


def shaped(model: BodyModel, factors: Floats) -> tuple[Floats, Floats]:
    """T-pose vertices (V,3) and joints (J,3) of a body with these factors: linear in them."""
    offset = factors - 1.0
    vertices = offset @ model.d_vertices.reshape(len(factors), -1)
    rest = offset @ model.d_rest.reshape(len(factors), -1)
    return model.vertices_m + vertices.reshape(-1, 3), model.rest_m + rest.reshape(-1, 3)


def shape_of(model: BodyModel, factors: Floats) -> BodyShape:
    """The body shape of these factors."""
    return BodyShape(model.stature_m, factors)


def _strongest(weights: Floats) -> tuple[NDArray[np.int32], Floats]:
    """The _BONES largest weights of each row, renormalised."""
    bones = np.argsort(-weights, axis=1)[:, :_BONES]
    kept = np.take_along_axis(weights, bones, axis=1)
    return bones.astype(np.int32), kept / kept.sum(axis=1, keepdims=True)


class Shaped(NamedTuple):
    """T-pose vertices (V,3), joints `rest` (J,3) and centres of the triangles (T,3) [m]."""

    vertices: Floats
    rest: Floats
    centres: Floats


class Shaper:
    """Shapes one body; remembers the last factors, which rarely change from one call to the next."""

    def __init__(self, model: BodyModel) -> None:
        self.model = model
        self._factors = b""  # compared as bytes: np.array_equal takes twenty times as long
        self._shaped = Shaped(model.vertices_m, model.rest_m, model.centres_m)

    def __call__(self, factors: Floats) -> Shaped:
        """The body with these factors (n_shape,). The arrays are not to be written to."""
        asked = factors.tobytes()
        if asked != self._factors:
            m = self.model
            vertices, rest = shaped(m, factors)
            offset = (factors - 1.0) @ m.d_centres.reshape(len(factors), -1)
            self._shaped = Shaped(vertices, rest, m.centres_m + offset.reshape(-1, 3))
            self._factors = asked
        return self._shaped
