"""The colour model and white balances of the shirt, from painted pictures."""

from collections.abc import Mapping

import numpy as np

from mocapd.shirt.colour.colour_model import ColourModel, fit_colour_model
from mocapd.shirt.colour.strokes import stroke_means
from mocapd.shirt.colour.white_balance import shade_precision, solve_white_balance
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Floats, LabelledPicture

# Spread of a printed or dyed standard colour, where no pictures of the shirt are given
_DYE_SD = 0.05


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


def white_balances(
    pictures: Mapping[str, LabelledPicture], model: ColourModel, plain: bool = False
) -> dict[str, Floats]:
    """W (3,3), model_from_camera on RGB 0..1, by camera; `plain` as in `white_balance_of`."""
    return {name: white_balance_of(one, model, plain) for name, one in pictures.items()}
