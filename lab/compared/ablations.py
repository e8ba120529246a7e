"""Ablations of the cue `clothes` and of `hecht2009`: edits of their params under which one step never triggers."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from mocapd.fit.terms.floor_term import FloorParams
from mocapd.published.hecht2009.params import Params as Hecht2009Params
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams

_SOFT_M, _SOFT_RAD = 1e3, 1e3  # standard deviations that hold nothing
_NO_FLOOR = FloorParams(under_sd_m=_SOFT_M, on_floor_sd_m=_SOFT_M)
_CERTAIN = 1e-6  # share of a limb's pixels, which any limb that is drawn has
_MORE_THAN_SAME = 1.01  # share of two regions' colours that is the same, correlation of two patches


def _no_joints(params: ClothesParams) -> ClothesParams:
    term = replace(params.joints.term, weight=0.0)
    return replace(params, joints=replace(params.joints, term=term))


def _no_arm_search(params: ClothesParams) -> ClothesParams:
    never = replace(params.limbs, uncertain_arm=_CERTAIN, uncertain_arm_small_baseline=_CERTAIN)
    return replace(params, limbs=never)


def _no_limits(params: ClothesParams) -> ClothesParams:
    soft = replace(params.fit, limit_sd_rad=_SOFT_RAD, collision_sd_m=_SOFT_M)
    return replace(params, fit=soft)


CLOTHES_ABLATIONS: Mapping[str, Callable[[ClothesParams], ClothesParams]] = MappingProxyType(
    {
        "no joints": _no_joints,
        "no texture": lambda p: replace(
            p, distances=replace(p.distances, least_alike=_MORE_THAN_SAME)
        ),
        "no depths": lambda p: replace(p, depths=replace(p.depths, least_alike=_MORE_THAN_SAME)),
        "no floor": lambda p: replace(p, floor=_NO_FLOOR, floor_before_crossing_views=_NO_FLOOR),
        "no arm search": _no_arm_search,
        "no shadows": lambda p: replace(
            p, background=replace(p.background, likely_shadow=(1.0, 0.0))
        ),
        "no leg search": lambda p: replace(p, legs=replace(p.legs, uncertain=_CERTAIN)),
        "no look-alikes": lambda p: replace(p, alike=_MORE_THAN_SAME),
        "no limits": _no_limits,
    }
)

HECHT2009_ABLATIONS: Mapping[str, Callable[[Hecht2009Params], Hecht2009Params]] = MappingProxyType(
    {
        "no depth noise": lambda p: replace(p, motion=replace(p.motion, depth_noise=False)),
        "no particle constraints": lambda p: replace(p, particle_constraints=False),
        "no occlusion": lambda p: replace(p, score=replace(p.score, occlusion=False)),
        "no appearance": lambda p: replace(p, score=replace(p.score, appearance=False)),
    }
)
