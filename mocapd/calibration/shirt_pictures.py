"""The pictures of the shirt that a folder, a file or a calibration names, checked."""

from collections.abc import Mapping
from pathlib import Path

from mocapd.boundary.files import is_file
from mocapd.errors import InputError
from mocapd.shirt.colour.strokes import require_pictures, stroked_pictures, strokes_beside
from mocapd.shirt.colour.white_balance import balanced
from mocapd.types import Floats, LabelledPicture

_PAINT = "paint the colours of the shirt again"


def stroked_image(image: Path) -> Path:
    """The same image. Raises InputError when it is missing, or the strokes beside it are."""
    for path in (image, strokes_beside(image)):
        if not is_file(path):
            raise InputError("no such file", str(path), _PAINT)
    return image


def stroked_folder(folder: Path) -> tuple[Path, ...]:
    """Every image of a folder, its strokes beside it. Raises InputError when there is none."""
    require_pictures(folder)
    images = stroked_pictures(folder)
    if not images:
        raise InputError("holds no image", str(folder), "it should hold 0.png, 0_strokes.png, ...")
    return tuple(stroked_image(image) for image in images)


def personal_model(
    pictures: Mapping[str, LabelledPicture], W: Mapping[str, Floats]
) -> tuple[LabelledPicture, ...]:
    """The wearer's own shirt in the light of the model, from pictures in the place's and W (3,3),
    model_from_camera, by camera: a dye that differs stays as a difference, the light does not."""
    return tuple(
        LabelledPicture(balanced(one.pixels, W[name]), one.labels) for name, one in pictures.items()
    )
