"""Make the published tracker from what is known of rig and person."""

from dataclasses import replace

from mocapd.calibration.record import Calibration
from mocapd.trackers.flex_paper.params import Params
from mocapd.trackers.flex_paper.section import FlexPaperSection
from mocapd.trackers.flex_paper.tracker import FlexPaperTracker
from mocapd.trackers.known import known_rig, stature_m
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.vision.face.lbp_cascade import blind_cascade, packaged_cascade_file, read_cascade


def build_flex_paper_tracker(
    calibration: Calibration,
    section: FlexPaperSection | None = None,
    tracking: TrackingStateParams | None = None,
) -> FlexPaperTracker:
    """The tracker as a user set it; without a cascade of faces it finds heads by outlines. Raises ConfigError naming
    what is missing."""
    file = packaged_cascade_file()
    cascade = blind_cascade() if file is None else read_cascade(file)
    rig, stature = known_rig(calibration), stature_m(calibration)
    return FlexPaperTracker(rig, stature, cascade, params_of(section), tracking)


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
