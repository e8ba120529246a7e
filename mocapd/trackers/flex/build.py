"""Make the tracker without a shirt from what is known of rig and person."""

from collections.abc import Callable
from dataclasses import replace

from mocapd.calibration.record import Calibration
from mocapd.each import Each, in_turn
from mocapd.fit.terms.floor_term import FloorParams
from mocapd.trackers.base import no_time_passes
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.section import FlexSection
from mocapd.trackers.flex.tracker import FlexTracker
from mocapd.trackers.known import known_rig, stature_m
from mocapd.trackers.steadying import Following
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.vision.face.lbp_cascade import frontal_faces

_SOFT_M, _SOFT_RAD = 1e3, 1e3  # standard deviations that hold nothing
_CERTAIN = 1e-6  # share of a limb's pixels, which any limb that is drawn has
_FOR_EVER = 1 << 30
_MORE_THAN_SAME = 1.01  # share of two regions' colours that is the same, correlation of two patches


def build_flex_tracker(
    calibration: Calibration,
    section: FlexSection | None = None,
    tracking: TrackingStateParams | None = None,
    each: Each = in_turn,
    now_ns: Callable[[], int] = no_time_passes,
) -> FlexTracker:
    """The tracker as a user set it; now_ns: see `registry.Resources`. Raises ConfigError naming what is missing."""
    rig, stature = known_rig(calibration), stature_m(calibration)
    return FlexTracker(rig, stature, params_of(section), tracking, frontal_faces(), each, now_ns)


def params_of(section: FlexSection | None) -> Params:
    """The tracker's numbers as a user set them: a step that is left out is one that decides nothing."""
    section = section if section is not None else FlexSection()
    usual = Params()
    params = replace(
        usual,
        live_explained=section.live_explained,
        start=replace(usual.start, accept_explained=section.accept_explained),
    )
    if not section.joints:
        term = replace(usual.joints.term, weight=0.0)
        params = replace(params, joints=replace(usual.joints, term=term))
    if not section.texture:
        nothing = replace(usual.distances, least_alike=_MORE_THAN_SAME)
        params = replace(params, distances=nothing)
    if not section.depths:
        params = replace(params, depths=replace(usual.depths, least_alike=_MORE_THAN_SAME))
    if not section.floor:
        soft = FloorParams(under_sd_m=_SOFT_M, standing_sd_m=_SOFT_M)
        params = replace(params, floor=soft)
    if not section.arm_search:
        params = replace(params, limbs=replace(usual.limbs, uncertain_arm=_CERTAIN))
    if not section.leg_search:
        never = replace(usual.legs, uncertain=_CERTAIN)
        params = replace(params, legs=never, crossed_looks=_FOR_EVER)
    if not section.faces:
        params = replace(params, facing=replace(usual.facing, sure=float("inf")))
    if not section.turns:
        params = replace(params, turning=replace(usual.turning, sure=float("inf")))
    if not section.shadows:
        all_before = replace(usual.background, likely_shadow=(1.0, 0.0))
        params = replace(params, background=all_before)
    if not section.look_alikes:
        params = replace(params, alike=_MORE_THAN_SAME)
    if not section.limits:
        soft_joints = replace(usual.fit, limit_sd_rad=_SOFT_RAD, collision_sd_m=_SOFT_M)
        params = replace(params, fit=soft_joints)
    if not section.steady:
        at_once = Following(sure=1.0, doubtful=0.0, least=1.0, doubtful_rad_s=_SOFT_RAD)
        steadying = replace(usual.steadying, sure_rad_s=_SOFT_RAD).with_all(at_once)
        params = replace(params, steadying=steadying)
    return params
