"""An arm that was found elsewhere, as it is published."""

from collections.abc import Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX
from mocapd.clock import nanoseconds
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.shirt.garment import shirt_labels
from mocapd.tracking.cues.clothes.clothes_solver import ClothesEstimate
from mocapd.tracking.pose_filter import PoseFilter
from mocapd.tracking.published_body import CueEstimates, publish_body
from mocapd.tracking.track_state import TrackState
from mocapd.tracking.tracking_state import DRIFT_M_S
from mocapd.types import Floats, Tracking
from tests.tracking.hypotheses.standing_body import FITTER, drawn, standing

pytestmark = pytest.mark.kernels

HAND = INDEX["leftHand"]
CAMERAS = SimpleNamespace(evidence=lambda views: ({}, {}))
CLOTHES: Any = SimpleNamespace(fitter=FITTER, cameras=CAMERAS)
UPPER = build_model(1.75)
SHIRT: Any = SimpleNamespace(
    model=UPPER, fitter=Fitter(UPPER, shirt_labels(UPPER), (), (), FitParams())
)
FRAME_NS = 33_333_333


def raised(state: MotionState) -> MotionState:
    local = state.local_xyzw.copy()
    local[INDEX["leftUpperArm"]] = rotations.exp(np.array([0.0, 0.0, 0.7]))
    return replace(state, local_xyzw=local)


def published(
    body: MotionState, views: Sequence[View], t_ns: int, changed: tuple[str, ...], by: PoseFilter
) -> Floats:
    """The left hand (3,) [m]."""
    fit = replace(FITTER.fit(body, views, 1 / 30, 1), state=body)
    found = ClothesEstimate(fit, body, tuple(views), ("cam0", "cam1"), changed)
    state = TrackState(t_ns, body, found.cameras, None, fit, t_ns, 0, changed)
    track = publish_body(
        state, body, CueEstimates(None, found), None, CLOTHES, by, t_ns, Tracking.LIVE, mean_shape(1.75)
    )  # fmt: skip
    assert track.body.joints_m is not None
    hand_m: Floats = track.body.joints_m[HAND]
    return hand_m


def share_of_the_way(cameras: int) -> float:
    """That the hand goes within 0.1 s."""
    by, here, there = PoseFilter(), standing(0.0, 0.1), raised(standing(0.0, 0.1))
    for k in range(20):
        at_m = published(here, drawn(here)[:cameras], k * FRAME_NS, (), by)
    for k in range(20, 23):
        changed = ("left_arm",) if k == 20 else ()
        now_m = published(there, drawn(there)[:cameras], k * FRAME_NS, changed, by)
    joints_m = [FITTER.joints(body)[0][HAND] for body in (here, there)]
    return float(np.linalg.norm(now_m - at_m) / np.linalg.norm(joints_m[1] - joints_m[0]))


def test_an_arm_found_elsewhere_is_doubted_unless_views_cross() -> None:
    """One camera alone sees no depth, as two side by side hardly do."""
    assert share_of_the_way(2) > 0.8
    assert share_of_the_way(1) < 0.6


def test_legs_that_nobody_sees_below_the_shirt_become_less_certain() -> None:
    """The shirt still shows trunk and arms, so only what it does not show is older."""

    def uncertainty_m(unseen_s: float) -> Floats:
        body, t_ns = standing(0.0, 0.1), 10**9
        fit = FITTER.fit(body, drawn(body), 1 / 30, 1)
        trunk = replace(fit, H=np.diag(np.full(SHIRT.model.n_pose, 1e4)))
        whole_ns = t_ns - nanoseconds(unseen_s)
        state = TrackState(t_ns, body, ("cam0",), trunk, fit, whole_ns, 0, by_shirt=True)
        track = publish_body(
            state, body, CueEstimates(), SHIRT, CLOTHES, PoseFilter(), t_ns, Tracking.LIVE, mean_shape(1.75)
        )  # fmt: skip
        assert track.body.uncertainty_m is not None
        return track.body.uncertainty_m

    seen_m, unseen_m = uncertainty_m(0.0), uncertainty_m(0.4)
    feet = [INDEX["leftFoot"], INDEX["rightFoot"]]
    assert (unseen_m[feet] >= 0.4 * DRIFT_M_S).all()
    assert unseen_m[HAND] == seen_m[HAND]
