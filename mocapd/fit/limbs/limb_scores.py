"""Image score of each limb hypothesis: supporting pixels outside the rest of the body, less contradicting ones."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mocapd.fit.idmap_renderer import PartialRender
from mocapd.fit.limbs.arm_samples import SKIN_LABEL, Arm, place_samples
from mocapd.fit.limbs.limb_candidates import turned_rad2
from mocapd.fit.limbs.limb_search_kernels import ArmSamples, score_arms, trunk_depths
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.types import Floats

PX_OF_M2 = 3.7e4  # work pixels that a square metre takes, by its distance [px m]; of usual lenses at some 2.7 m
_NO_DEPTHS = np.empty((0, 0), np.float32)


def has_depths(views: Sequence[View]) -> bool:
    """Whether some view has stereo depth."""
    return any(view.depth_m is not None for view in views)


def score_hand_places(
    fitter: Fitter,
    state: MotionState,
    arm: Arm,
    views: Sequence[View],
    hypotheses: Floats,
    empty: float,
) -> Floats:
    """Skin score of the hand of each hypothesis (N,3,4) outside the head and the other hand, less contradicting pixels
    (N,) [work px]; 0 without a skin mask. empty: as for arms."""
    none = np.zeros(len(hypotheses))
    looked = [view for view in views if view.bare is not None]
    if not looked:
        return none
    samples = place_samples(fitter.shaper(state.factors), arm, arm.hand)

    def score_in(view: View) -> Floats:
        base = fitter.drawings[view.index].render_parts(state, view.dt_s, view.roi, arm.others)
        return _hands_in_view(fitter, view, base, arm, samples, hypotheses, empty)

    score_px: Floats = PX_OF_M2 * sum(fitter.each(score_in, looked), none)
    return score_px


def score_arms_and_hands(
    fitter: Fitter,
    state: MotionState,
    arm: Arm,
    views: Sequence[View],
    hypotheses: Floats,
    farther: float,
    empty: float,
) -> tuple[Floats, Floats]:
    """Image score of each hypothesis (N,3,4), less a penalty for the depth in the trunk (N,) [work px], and
    `score_hand_places`, with one drawing of the rest of the body for both.

    farther: penalty for the distance from the first pose [work px/rad^2]; empty: weight of the pixels without a label
    against it.
    """
    none = np.zeros(len(hypotheses))
    # stereo depth separates an arm from a trunk of the same colour
    covered = 0.0 if has_depths(views) else 1.0
    scores = _penalties_m2(fitter, state, arm, views, hypotheses, farther)
    body = fitter.shaper(state.factors)
    sleeve, hand = place_samples(body, arm, arm.labelled), place_samples(body, arm, arm.hand)

    def score_in(view: View) -> tuple[Floats, Floats]:
        base = fitter.drawings[view.index].render_parts(state, view.dt_s, view.roi, arm.others)
        arms = _scores_in_view(
            fitter, view, base, base.ids, view.ids, sleeve, hypotheses, empty, covered
        )
        if view.bare is None:
            return arms, none
        return arms, _hands_in_view(fitter, view, base, arm, hand, hypotheses, empty)

    arms, hands = zip(*fitter.each(score_in, views), strict=True)
    return PX_OF_M2 * sum(arms, scores), PX_OF_M2 * sum(hands, none)


def _penalties_m2(
    fitter: Fitter,
    state: MotionState,
    arm: Arm,
    views: Sequence[View],
    hypotheses: Floats,
    farther: float,
) -> Floats:
    """What each hypothesis loses by its distance from the first and by its depth in the trunk, below 0 (N,) [m^2]."""
    model, body, arms = fitter.model, fitter.shaper(state.factors), fitter.trunk.arms
    drawing = fitter.drawings[views[0].index]
    drawing.pose(state.root_m, state.local_xyzw, body.rest)
    depths_m2 = np.empty(len(hypotheses))
    trunk_depths(
        hypotheses, arm.chain, model.parents, drawing.posed, fitter.trunk.slices(body),
        arms.hips, arms.chest, arms.top, depths_m2,
    )  # fmt: skip
    away_rad2 = turned_rad2(hypotheses[:, 1:], hypotheses[0, 1:])
    lost: Floats = -(farther * away_rad2 + fitter.params.collision_information * depths_m2)
    return lost / PX_OF_M2


def added_in_views(
    fitter: Fitter,
    state: MotionState,
    limb: Arm,
    views: Sequence[View],
    samples: ArmSamples,
    hypotheses: Floats,
    empty: float,
    scores: Floats,
) -> Floats:
    """scores (N,) plus each camera's score of a limb in front of the rest of the body [m^2]."""

    def score_in(view: View) -> Floats:
        base = fitter.drawings[view.index].render_parts(state, view.dt_s, view.roi, limb.others)
        return _scores_in_view(fitter, view, base, base.ids, view.ids, samples, hypotheses, empty)

    # sum in the order of the views, not of the threads
    return sum(fitter.each(score_in, views), scores)


def _hands_in_view(
    fitter: Fitter,
    view: View,
    base: PartialRender,
    arm: Arm,
    samples: ArmSamples,
    hypotheses: Floats,
    empty: float,
) -> Floats:
    """One camera's scores of the hands (N,) [m^2], with skin as a label."""
    assert view.bare is not None
    drawn = np.where(arm.is_skin[base.triangle_at], np.uint8(SKIN_LABEL), base.ids)
    shown = np.where(view.bare, np.uint8(SKIN_LABEL), view.ids)
    return _scores_in_view(fitter, view, base, drawn, shown, samples, hypotheses, empty)


def _scores_in_view(
    fitter: Fitter,
    view: View,
    base: PartialRender,
    drawn: NDArray[np.uint8],
    shown: NDArray[np.uint8],
    samples: ArmSamples,
    hypotheses: Floats,
    empty: float,
    covered: float = 1.0,
) -> Floats:
    """One camera's scores (N,) [m^2], of ids (h,w) `drawn` without the arm and `shown` in the picture; see `score_arms`."""
    drawing, scores = fitter.drawings[view.index], np.zeros(len(hypotheses))
    image_scale = drawing.image_scale
    score_arms(
        hypotheses, samples, fitter.model.parents, base.posed, drawing.projection,
        np.array([float(view.roi[0] * image_scale), float(view.roi[1] * image_scale)]), 1.0 / image_scale,
        base.zbuffer, drawn, shown, view.pixel_weight, empty, covered,
        _NO_DEPTHS if view.depth_m is None else view.depth_m, fitter.params.depth_off_m, scores,
    )  # fmt: skip
    return scores
