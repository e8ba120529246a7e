"""The pictures of the shirt in neutral light, for the colour model: found, read and checked."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mocapd.boundary.files import is_file
from mocapd.errors import ConfigError, InputError
from mocapd.shirt.colour.strokes import (
    read_labelled,
    stroked_pictures,
    strokes_path,
)
from mocapd.shirt.colour.white_balance import apply_white_balance
from mocapd.shirt.standard_shirt import N_COLOURS, standard_shirt
from mocapd.types import Floats, LabelledPicture


def stroked_image(image: Path) -> Path:
    """The same image. Raises InputError when it or its stroke file is missing."""
    for path in (image, strokes_path(image)):
        if not is_file(path):
            raise InputError("no such file", str(path), "paint the colours of the shirt again")
    return image


def stroked_folder(folder: Path) -> tuple[Path, ...]:
    """Every image of a folder, with its stroke file. Raises InputError when there is none."""
    images = stroked_pictures(folder)
    if not images:
        raise InputError("holds no image", str(folder), "it should hold 0.png, 0_strokes.png, ...")
    return tuple(stroked_image(image) for image in images)


def read_model(images: tuple[Path, ...]) -> tuple[LabelledPicture, ...]:
    """The images of the shirt. Raises ConfigError when a colour has no stroke on any of them."""
    pictures = tuple(read_labelled(image) for image in images)
    if pictures:
        painted = np.unique(np.concatenate([np.unique(p.labels) for p in pictures]))
        missing = sorted(set(range(1, N_COLOURS + 1)) - set(painted.tolist()))
        if missing:
            names = ", ".join(f"{i} ({standard_shirt().colour_names[i - 1]})" for i in missing)
            raise ConfigError(
                f"no stroke of colour {names} on any image",
                str(images[0].parent),
                "paint it where the shirt shows it",
            )
    return pictures


def personal_model(
    pictures: Mapping[str, LabelledPicture], W: Mapping[str, Floats]
) -> tuple[LabelledPicture, ...]:
    """The wearer's own shirt in the light of the model, from pictures in the place's and W (3,3),
    model_from_camera, by camera: a dye that differs stays as a difference, the light does not."""
    return tuple(
        LabelledPicture(apply_white_balance(one.pixels, W[name]), one.labels)
        for name, one in pictures.items()
    )
