"""Make the published tracker from what is known of rig and person."""

from dataclasses import replace

from mocapd.calibration.record import Calibration
from mocapd.trackers.flex_paper.params import Params
from mocapd.trackers.flex_paper.section import FlexPaperSection
from mocapd.trackers.flex_paper.tracker import FlexPaperTracker
from mocapd.trackers.known import known_rig, stature_m
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.vision.face.lbp_cascade import frontal_faces


def build_flex_paper_tracker(
    calibration: Calibration,
    section: FlexPaperSection | None = None,
    tracking: TrackingStateParams | None = None,
) -> FlexPaperTracker:
    """The tracker as a user set it. Raises ConfigError naming what is missing."""
    rig, stature = known_rig(calibration), stature_m(calibration)
    return FlexPaperTracker(rig, stature, frontal_faces(), params_of(section), tracking)


def params_of(section: FlexPaperSection | None) -> Params:
    """The tracker's numbers as a user set them."""
    section = section if section is not None else FlexPaperSection()
    usual = Params()
    return replace(
        usual,
        particles=section.particles,
        particle_constraints=section.particle_constraints,
        motion=replace(usual.motion, depth_noise=section.depth_noise),
        score=replace(usual.score, occlusion=section.occlusion, appearance=section.appearance),
    )
