"""Make a colour tracker from what the user has: rig, stature, painted pictures, pose database."""

from collections.abc import Mapping

import numpy as np

from mocapd.body.shirt import standard_shirt
from mocapd.errors import ConfigError
from mocapd.shirt.colour.colour_model import ColourModel, fit_colour_model
from mocapd.shirt.colour.strokes import stroke_means
from mocapd.shirt.colour.white_balance import shade_precision, solve_white_balance
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.trackers.base import Tracker
from mocapd.trackers.colour.params import Params
from mocapd.trackers.colour.tracker import ColourTracker
from mocapd.trackers.colour_paper.params import Params as PaperParams
from mocapd.trackers.colour_paper.params import tolerant
from mocapd.trackers.colour_paper.tracker import PaperTracker
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.types import Floats, LabelledPicture, Rig

VARIANTS = ("full", "paper", "paper-tolerant", "baseline", "baseline-tolerant")
# Spread of a printed or dyed standard colour, where no pictures of the shirt are given
_DYE_SD = 0.05


def build_colour_tracker(
    rig: Rig | None,
    stature_m: float,
    model: tuple[LabelledPicture, ...],
    white_balance: Mapping[str, LabelledPicture],
    database: PoseDatabase | None,
    variant: str = "full",
    tracking: TrackingStateParams | None = None,
    factors: Floats | None = None,
) -> Tracker:
    """The tracker of this variant. Raises ConfigError naming what is missing.

    factors (N_FACTORS,): the wearer's proportions as measured; the paper's variants know none.
    """
    if rig is None:
        raise ConfigError(
            "the colour tracker needs calibrated cameras", "rig", "give a rig file (rig = ...)"
        )
    if database is None:
        raise ConfigError(
            "no pose database was given", "tracker.name", "this is a defect of mocapd"
        )
    if variant not in VARIANTS:
        raise ConfigError(
            f"there is no variant {variant!r}", "tracker.variant", f"one of: {', '.join(VARIANTS)}"
        )
    colours = colour_model(model)
    W = {
        camera: white_balance_of(picture, colours, plain=variant != "full")
        for camera, picture in white_balance.items()
    }
    if variant == "full":
        return ColourTracker(rig, stature_m, colours, W, database, Params(), tracking, factors)
    published = PaperParams()
    if variant.startswith("baseline"):
        published = PaperParams(pose_prior=False, adaptive_white_balance=False)
    if variant.endswith("tolerant"):
        published = tolerant(published)
    return PaperTracker(rig, stature_m, colours, W, database, published)


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
