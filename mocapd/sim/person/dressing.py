"""What a person wears as arrays for the kernels, and the jacket as more thickness of the body."""

import numpy as np
from numpy.typing import NDArray

from mocapd.body.shape import BodyShape
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import HEAD, LEFT_ARM, RIGHT_ARM, TOP, TORSO, TROUSERS
from mocapd.sim.colour import linear_from_srgb
from mocapd.sim.person.dress_kernels import (
    CHECKS,
    CHEST,
    CLOTHS,
    FACE,
    FLAT,
    LEG,
    NECK_Y,
    NECK_Z,
    PLAIN,
    PRINT,
    REACH,
    SIZE,
    SLEEVE,
    SLEEVE_END,
    STRIPES,
    TRUNK,
    Dress,
)
from mocapd.sim.person.subdivision import FineSurface
from mocapd.sim.person_spec import Clothes, Jacket, Weave
from mocapd.sim.scenario_values import Srgb
from mocapd.types import Bytes, Floats, Skeleton

_PATTERNS = {"plain": PLAIN, "stripes": STRIPES, "checks": CHECKS, "print": PRINT}
_HEM = 0.035  # of a jacket below the joint of the hips, in statures
_SHORT = 0.62  # of the upper arm that a short sleeve covers


def dress_of(
    fine: FineSurface, skeleton: Skeleton, clothes: Clothes, shape: BodyShape, *, face: bool
) -> Dress:
    """Of one person. Where nothing but the shirt is worn, every triangle has its own colour."""
    stature_m = shape.stature_m
    arms = (fine.part == LEFT_ARM) | (fine.part == RIGHT_ARM)
    top, trousers = fine.material == TOP, fine.material == TROUSERS
    rule = np.full(len(fine.triangles), FLAT, dtype=np.uint8)
    if face:
        rule[fine.part == HEAD] = FACE
    if clothes.shirt == "plain":
        rule[top & arms] = SLEEVE
        rule[top & ~arms] = TRUNK
    if clothes.trousers_weave.pattern != "plain":
        rule[trousers] = LEG
    elbow_x, wrist_x, arm_x = (
        skeleton.rest_m[INDEX["left" + bone], 0] for bone in ("LowerArm", "Hand", "UpperArm")
    )
    short = clothes.shirt == "plain" and clothes.sleeves == "short"
    jacket = clothes.jacket or Jacket()
    cloths = (
        (clothes.skin_srgb, Weave()),
        (clothes.hair_srgb, Weave()),
        (clothes.top_srgb, clothes.top_weave),
        (clothes.trousers_srgb, clothes.trousers_weave),
        (jacket.srgb, jacket.weave),
    )
    _, neck_y, neck_z = skeleton.rest_m[INDEX["neck"]]
    numbers = [0.0] * CLOTHS
    numbers[NECK_Y], numbers[NECK_Z] = neck_y, neck_z
    numbers[SIZE] = stature_m * shape.factor("head_size")
    numbers[CHEST] = skeleton.rest_m[INDEX["upperChest"], 1]
    numbers[SLEEVE_END] = arm_x + _SHORT * (elbow_x - arm_x) if short else 2.0 * wrist_x
    numbers[REACH] = wrist_x
    rows = [
        [*_linear(srgb), *_linear(weave.srgb), _PATTERNS[weave.pattern], weave.period_m]
        for srgb, weave in cloths
    ]
    return Dress(
        rest_m=fine.vertices_m,
        rule=rule,
        under_jacket=_under_jacket(fine, skeleton, stature_m, worn=clothes.jacket is not None),
        person=np.zeros(len(fine.triangles), dtype=np.int32),
        outfits=np.array([[*numbers, *np.concatenate(rows)]]),
    )


def _linear(srgb: Srgb) -> Floats:
    return np.clip(linear_from_srgb(srgb), 0.01, 0.95)


def _under_jacket(fine: FineSurface, skeleton: Skeleton, stature_m: float, *, worn: bool) -> Bytes:
    out = np.full(len(fine.triangles), FLAT, dtype=np.uint8)
    if worn:
        height = fine.vertices_m[fine.triangles, 1].mean(axis=1)
        hem_m = skeleton.rest_m[INDEX["hips"], 1] - _HEM * stature_m
        out[(fine.part == TORSO) & (height > hem_m)] = TRUNK
        out[(fine.material == TOP) & (fine.part != TORSO)] = SLEEVE
    return out


def jacket_height(
    fine: FineSurface, dress: Dress, clothes: Clothes, rng: np.random.Generator
) -> tuple[Floats, NDArray[np.int32]]:
    """How far a jacket holds its outside off the body (V,) [m], 0 where there is none, and which vertices (N,)
    it is over."""
    height = np.zeros(len(fine.vertices_m))
    over = np.unique(fine.triangles[dress.under_jacket > 0]).astype(np.int32)
    if clothes.jacket is not None:
        wave = np.zeros(len(over))
        for _ in range(4):
            direction = rng.normal(size=3)
            direction *= 2 * np.pi / (rng.uniform(0.10, 0.22) * np.linalg.norm(direction))
            wave += np.sin(fine.vertices_m[over] @ direction + rng.uniform(0, 6.3))
        height[over] = clothes.jacket.thickness_m * (1.0 + 0.18 * wave)
    return height, over


def joined_dresses(dresses: list[Dress]) -> Dress:
    """One dress for several people with concatenated meshes."""
    if len(dresses) == 1:
        return dresses[0]
    joined = Dress(*(np.concatenate(arrays) for arrays in zip(*dresses, strict=True)))
    person = np.repeat(np.arange(len(dresses)), [len(one.person) for one in dresses])
    return joined._replace(person=person.astype(np.int32))
