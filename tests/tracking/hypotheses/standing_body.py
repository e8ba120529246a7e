"""Somebody who stands before two cameras, and a fitter of the regions of clothes."""

from collections.abc import Callable

import numpy as np

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_params import FitParams, LegSearchParams, LimbSearchParams
from mocapd.fit.limbs.arm_search import ArmSearch
from mocapd.fit.limbs.leg_search import LegSearch
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.tracking.cues.clothes.region_merge import RegionSolvers
from mocapd.tracking.cues.clothes.regions import region_labels
from mocapd.tracking.hypotheses.base import HypothesisContext, PoseEvidence
from mocapd.tracking.ticks import Ticks
from tests.geometry.rigs import ring

BODY = build_model(1.75, full_body())
FITTER = Fitter(BODY, region_labels(BODY), ring(2), [2, 2], FitParams())


def standing(yaw_rad: float, spread_rad: float) -> MotionState:
    """Somebody upright whose legs are turned outwards, or over each other."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    local[0] = rotations.exp(np.array([0.0, yaw_rad, 0.0]))
    for side, mirror in (("left", 1.0), ("right", -1.0)):
        turned = np.array([0.0, 0.0, mirror * spread_rad])
        local[INDEX[side + "UpperLeg"]] = rotations.exp(turned)
    space = BODY.space
    return MotionState(
        BODY.rest_m[0].copy(), local, np.zeros(BODY.n_pose), np.ones(BODY.n_shape), initial_information(space)
    )  # fmt: skip


def drawn(state: MotionState, fitter: Fitter = FITTER) -> list[View]:
    """Pictures in which each region is where this body has it."""
    views = []
    for i, drawing in enumerate(fitter.drawings):
        roi = drawing.region(state, 0.0, 26)
        assert roi is not None
        ids = drawing.render(state, 0.0, roi).copy()
        views.append(View(i, roi, ids, np.full(ids.shape, 255, np.uint8), 0.0))
    return views


def context(fitter: Fitter, classify: Callable[[MotionState], list[View]]) -> HypothesisContext:
    """A frame set without keypoints; classify: the pictures, classified about a pose."""
    solvers = RegionSolvers(
        fitter, ArmSearch(fitter, LimbSearchParams()), LegSearch(fitter, LegSearchParams())
    )
    evidence = PoseEvidence(classify, lambda _, __: ())
    return HypothesisContext(solvers, 1.0 / 30.0, Ticks(1, 3, 1), (), evidence)
