"""Ablations: trackers with one step disabled, as edits of their Params, and the published methods as rivals.

A disabled step gets parameters under which it never triggers; the product has no switch for it.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from mocapd.fit.terms.floor_term import FloorParams
from mocapd.trackers.colour_paper.params import published
from mocapd.trackers.flex.params import Params as FlexParams
from mocapd.trackers.flex_paper.params import Params as FlexPaperParams
from mocapd.trackers.steadying import Following

_SOFT_M, _SOFT_RAD = 1e3, 1e3  # standard deviations that hold nothing
_CERTAIN = 1e-6  # share of a limb's pixels, which any drawn limb has
_NEVER = 1 << 30  # frames
_MORE_THAN_SAME = 1.01  # of a share or a correlation, which is at most 1


@dataclass(frozen=True, slots=True, eq=False)
class Rival:
    """A tracker to compare with. params: None for its own."""

    tracker: str
    params: Any = None


def flex_ablations() -> Mapping[str, FlexParams]:
    """By label, the tracker without a shirt with one step disabled."""
    usual = FlexParams()
    immediate = Following(sure=1.0, doubtful=0.0, least=1.0, doubtful_rad_s=_SOFT_RAD)
    return {
        "no joints": replace(
            usual, joints=replace(usual.joints, term=replace(usual.joints.term, weight=0.0))
        ),
        "no texture": replace(
            usual, distances=replace(usual.distances, least_alike=_MORE_THAN_SAME)
        ),
        "no depths": replace(usual, depths=replace(usual.depths, least_alike=_MORE_THAN_SAME)),
        "no floor": replace(usual, floor=FloorParams(under_sd_m=_SOFT_M, standing_sd_m=_SOFT_M)),
        "no arm search": replace(usual, limbs=replace(usual.limbs, uncertain_arm=_CERTAIN)),
        "no leg search": replace(
            usual, legs=replace(usual.legs, uncertain=_CERTAIN), crossed_looks=_NEVER
        ),
        "no faces": replace(usual, facing=replace(usual.facing, sure=float("inf"))),
        "no turns": replace(usual, turning=replace(usual.turning, sure=float("inf"))),
        "no shadows": replace(
            usual, background=replace(usual.background, likely_shadow=(1.0, 0.0))
        ),
        "no look-alikes": replace(usual, alike=_MORE_THAN_SAME),
        "no limits": replace(
            usual, fit=replace(usual.fit, limit_sd_rad=_SOFT_RAD, collision_sd_m=_SOFT_M)
        ),
        "not steady": replace(
            usual,
            steadying=replace(usual.steadying, sure_rad_s=_SOFT_RAD).with_all(immediate),
        ),
    }


def flex_paper_ablations() -> Mapping[str, FlexPaperParams]:
    """By label, the published tracker without a shirt with one of the paper's steps disabled."""
    usual = FlexPaperParams()
    return {
        "no depth noise": replace(usual, motion=replace(usual.motion, depth_noise=False)),
        "no particle constraints": replace(usual, particle_constraints=False),
        "no occlusion": replace(usual, score=replace(usual.score, occlusion=False)),
        "no appearance": replace(usual, score=replace(usual.score, appearance=False)),
    }


def rivals_of(tracker: str) -> Mapping[str, Rival]:
    """What a tracker is compared with, by label; empty for one that is compared with nothing."""
    if tracker == "colour":
        baseline = published(baseline=True)
        return {"paper": Rival("colour_paper"), "baseline": Rival("colour_paper", baseline)}
    if tracker == "flex":
        steps = flex_ablations().items()
        return {
            "paper": Rival("flex_paper"),
            **{label: Rival("flex", params) for label, params in steps},
        }
    if tracker == "flex_paper":
        steps = flex_paper_ablations().items()
        return {label: Rival("flex_paper", params) for label, params in steps}
    return {}
