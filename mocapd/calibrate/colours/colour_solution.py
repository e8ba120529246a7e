"""What strokes in the present light give: each camera's white balance, and the wearer's own shirt's colours."""

from collections.abc import Mapping

from mocapd.shirt.colour.colour_model import ColourModel, fit_colour_model
from mocapd.shirt.colour.from_pictures import white_balance_of
from mocapd.shirt.colour.white_balance import balanced
from mocapd.types import Floats, LabelledPicture


def white_balances(
    pictures: Mapping[str, LabelledPicture], model: ColourModel
) -> dict[str, Floats]:
    """W (3,3), model_from_camera on RGB 0..1, by camera, as the full tracker reads it."""
    return {name: white_balance_of(p, model, plain=False) for name, p in pictures.items()}


def personal_colour_model(
    pictures: Mapping[str, LabelledPicture], model: ColourModel
) -> ColourModel:
    """The colours of the wearer's own shirt, from stroked pictures in any light.

    Each picture is brought to the light of `model` by its own W first, so that the new model and the
    old W belong together: a dye that differs from the standard stays as a difference, the light does
    not. Raises ConfigError that names each colour with too few strokes in all pictures together.
    """
    W = white_balances(pictures, model)
    return fit_colour_model(
        [balanced(p.pixels, W[name]) for name, p in pictures.items()],
        [p.labels for p in pictures.values()],
        model.names,
        f"{model.version} (personal)",
    )
