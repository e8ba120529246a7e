"""Make a colour tracker from what is known of rig, wearer and shirt, and the pose database."""

import numpy as np

from mocapd.body.shirt_patches import standard_shirt
from mocapd.calibration.record import Calibration, ShirtColours
from mocapd.errors import ConfigError
from mocapd.shirt.colour.colour_model import ColourModel, fit_colour_model
from mocapd.shirt.colour.strokes import stroke_means
from mocapd.shirt.colour.white_balance import shade_precision, solve_white_balance
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.trackers.base import Tracker, stature_m
from mocapd.trackers.colour.params import Params
from mocapd.trackers.colour.tracker import ColourTracker
from mocapd.trackers.colour_paper.params import Params as PaperParams
from mocapd.trackers.colour_paper.params import tolerant
from mocapd.trackers.colour_paper.tracker import PaperTracker
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.types import Floats, LabelledPicture

VARIANTS = ("full", "paper", "paper-tolerant", "baseline", "baseline-tolerant")
# Spread of a printed or dyed standard colour, where no pictures of the shirt are given
_DYE_SD = 0.05


def build_colour_tracker(
    calibration: Calibration,
    database: PoseDatabase,
    variant: str = "full",
    tracking: TrackingStateParams | None = None,
) -> Tracker:
    """The tracker of this variant. Raises ConfigError naming what is missing.

    The paper's variants know nothing of the wearer's proportions.
    """
    rig, tall_m = calibration.rig, stature_m(calibration)
    if rig is None:
        raise ConfigError(
            "the colour tracker needs calibrated cameras", "rig", "give a rig file (rig = ...)"
        )
    if variant not in VARIANTS:
        raise ConfigError(
            f"there is no variant {variant!r}", "tracker.variant", f"one of: {', '.join(VARIANTS)}"
        )
    shirt = calibration.shirt or ShirtColours()
    colours = colour_model(shirt.model)
    W = {
        camera: white_balance_of(picture, colours, plain=variant != "full")
        for camera, picture in shirt.white_balance.items()
    }
    if variant == "full":
        factors = calibration.wearer.shape_factors
        return ColourTracker(rig, tall_m, colours, W, database, Params(), tracking, factors)
    published = PaperParams()
    if variant.startswith("baseline"):
        published = PaperParams(pose_prior=False, adaptive_white_balance=False)
    if variant.endswith("tolerant"):
        published = tolerant(published)
    return PaperTracker(rig, tall_m, colours, W, database, published)


def colour_model(pictures: tuple[LabelledPicture, ...]) -> ColourModel:
    """From the painted pictures; without any, the colours of the shirt's standard as printed."""
    shirt = standard_shirt()
    if pictures:
        return fit_colour_model(
            [p.pixels for p in pictures],
            [p.labels for p in pictures],
            shirt.colour_names,
            shirt.version,
        )
    covariance = np.tile(np.eye(3) * _DYE_SD**2, (len(shirt.colour_names), 1, 1))
    return ColourModel(shirt.colour_names, shirt.srgb / 255.0, covariance, shirt.version)


def white_balance_of(picture: LabelledPicture, model: ColourModel, plain: bool) -> Floats:
    """W (3,3) from one painted picture; `plain`: the paper's least squares, else hue before brightness."""
    means, counts = stroke_means(picture.pixels, picture.labels)
    return solve_white_balance(
        means, model.mean, counts.astype(float), precision=None if plain else shade_precision(model)
    )
