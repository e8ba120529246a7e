"""Ablations of the cue `clothes` and of `hecht2009`: edits of their params under which one step never triggers."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from mocapd.fit.terms.floor_term import FloorParams
from mocapd.published.hecht2009.params import Params as Hecht2009Params
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams

_SOFT_M, _SOFT_RAD = 1e3, 1e3  # standard deviations that hold nothing
_CERTAIN = 1e-6  # share of a limb's pixels, which any limb that is drawn has
_MORE_THAN_SAME = 1.01  # share of two regions' colours that is the same, correlation of two patches


def _no_joints(params: ClothesParams) -> ClothesParams:
    term = replace(params.joints.term, weight=0.0)
    return replace(params, joints=replace(params.joints, term=term))


def _no_texture(params: ClothesParams) -> ClothesParams:
    return replace(params, distances=replace(params.distances, least_alike=_MORE_THAN_SAME))


def _no_depths(params: ClothesParams) -> ClothesParams:
    return replace(params, depths=replace(params.depths, least_alike=_MORE_THAN_SAME))


def _no_floor(params: ClothesParams) -> ClothesParams:
    return replace(params, floor=FloorParams(under_sd_m=_SOFT_M, on_floor_sd_m=_SOFT_M))


def _no_arm_search(params: ClothesParams) -> ClothesParams:
    never = replace(params.limbs, uncertain_arm=_CERTAIN, uncertain_arm_small_baseline=_CERTAIN)
    return replace(params, limbs=never)


def _no_leg_search(params: ClothesParams) -> ClothesParams:
    return replace(params, legs=replace(params.legs, uncertain=_CERTAIN))


def _no_shadows(params: ClothesParams) -> ClothesParams:
    return replace(params, background=replace(params.background, likely_shadow=(1.0, 0.0)))


def _no_look_alikes(params: ClothesParams) -> ClothesParams:
    return replace(params, alike=_MORE_THAN_SAME)


def _no_limits(params: ClothesParams) -> ClothesParams:
    soft = replace(params.fit, limit_sd_rad=_SOFT_RAD, collision_sd_m=_SOFT_M)
    return replace(params, fit=soft)


CLOTHES_ABLATIONS: Mapping[str, Callable[[ClothesParams], ClothesParams]] = MappingProxyType(
    {
        "no joints": _no_joints,
        "no texture": _no_texture,
        "no depths": _no_depths,
        "no floor": _no_floor,
        "no arm search": _no_arm_search,
        "no shadows": _no_shadows,
        "no leg search": _no_leg_search,
        "no look-alikes": _no_look_alikes,
        "no limits": _no_limits,
    }
)


def _no_depth_noise(params: Hecht2009Params) -> Hecht2009Params:
    return replace(params, motion=replace(params.motion, depth_noise=False))


def _no_particle_constraints(params: Hecht2009Params) -> Hecht2009Params:
    return replace(params, particle_constraints=False)


def _no_occlusion(params: Hecht2009Params) -> Hecht2009Params:
    return replace(params, score=replace(params.score, occlusion=False))


def _no_appearance(params: Hecht2009Params) -> Hecht2009Params:
    return replace(params, score=replace(params.score, appearance=False))


HECHT2009_ABLATIONS: Mapping[str, Callable[[Hecht2009Params], Hecht2009Params]] = MappingProxyType(
    {
        "no depth noise": _no_depth_noise,
        "no particle constraints": _no_particle_constraints,
        "no occlusion": _no_occlusion,
        "no appearance": _no_appearance,
    }
)
