"""Solves the colours of the wearer's own shirt from strokes in the present light."""

from collections.abc import Mapping

from mocapd.shirt.colour.colour_model import ColourModel, fit_colour_model
from mocapd.shirt.colour.from_pictures import white_balances
from mocapd.shirt.colour.white_balance import apply_white_balance
from mocapd.types import LabelledPicture


def personal_colour_model(
    pictures: Mapping[str, LabelledPicture], model: ColourModel
) -> ColourModel:
    """The colours of the wearer's own shirt, from stroked pictures in any light.

    W first maps each picture to the light of `model`, so that the new model fits the old W: a difference of
    the dye from the standard remains, the light does not. Raises ConfigError that names each colour with too
    few strokes in all pictures together.
    """
    W = white_balances(pictures, model)
    return fit_colour_model(
        [apply_white_balance(p.pixels, W[name]) for name, p in pictures.items()],
        [p.labels for p in pictures.values()],
        model.names,
        f"{model.version} (personal)",
    )
