"""The pictures of the shirt in neutral light, for the colour model: read and checked."""

from pathlib import Path

import numpy as np

from mocapd.body.shirt_patches import N_COLOURS, standard_shirt
from mocapd.errors import ConfigError
from mocapd.shirt.colour.strokes import read_labelled
from mocapd.types import LabelledPicture


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
