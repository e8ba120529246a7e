"""Stroke images: a person's coarse scribbles, one colour id per shirt colour, and their pixels."""

from pathlib import Path

import cv2
import numpy as np

from mocapd.boundary.files import is_file, read_file
from mocapd.boundary.image_decoding import MOST_DRAWN_PIXELS, MOST_FILE_BYTES, decode_picture
from mocapd.boundary.listing import shown_in
from mocapd.errors import InputError, MalformedError
from mocapd.types import Bytes, Floats, LabelledPicture

COLOURS = 10
_STROKES = "_strokes"  # at the end of a file's name
_SCRIBBLE_AGAIN = "scribble again: 0 where nothing is drawn, 1..10 the colour id"

# A stroke is drawn on one patch, so most of its pixels show that patch. The centre is estimated
# from the innermost three quarters (fast MCD); 1.61 makes their covariance consistent with the
# full Gaussian's: 0.75 / P(chi2_5 <= quantile of chi2_3 at 0.75).
_CORE_FRACTION = 0.75
_CORE_TO_FULL_VARIANCE = 1.61
_CHI2_3_AT_0_999 = 16.27
_CONCENTRATION_STEPS = 5
_PIXEL_NOISE_VARIANCE = 0.015**2


def stroked_pictures(folder: Path) -> list[Path]:
    """The pictures of a folder with stroke files, by name: every PNG but NAME_strokes.png, and NAME_labels.png,
    which is ground truth. Raises as `require_pictures`."""
    require_pictures(folder)
    suffixes = (_STROKES, "_labels")
    return [path for path in shown_in(folder) if _is_png(path) and not path.stem.endswith(suffixes)]


def require_pictures(folder: Path) -> None:
    """Raises InputError for strokes in a folder without the picture on which they were drawn."""
    for strokes in shown_in(folder):
        if not _is_png(strokes) or not strokes.stem.endswith(_STROKES):
            continue
        picture = strokes.with_name(f"{strokes.stem.removesuffix(_STROKES)}.png")
        if not is_file(picture):
            raise InputError(
                "the picture of these strokes is missing",
                str(strokes),
                f"put {picture.name} into the same folder, or take them out",
            )


def _is_png(path: Path) -> bool:
    return path.suffix == ".png"


def strokes_path(picture: Path) -> Path:
    return picture.with_name(f"{picture.stem}{_STROKES}.png")


def read_image(path: Path) -> Bytes:
    """A colour image file as (h,w,3) uint8 BGR. Raises InputError."""
    return _read(path, cv2.IMREAD_COLOR)


def read_strokes(path: Path, size_px: tuple[int, int] | None = None) -> Bytes:
    """A stroke image file as labels (h,w) uint8; `size_px` (width, height) is what it must have.

    Gray files, and colour files with equal channels, hold the ids themselves. Raises InputError.
    """
    image = _read(path, cv2.IMREAD_UNCHANGED)
    if image.ndim == 3:
        if (image[..., :3] != image[..., :1]).any():
            raise InputError("is painted in colours, not ids", str(path), _SCRIBBLE_AGAIN)
        image = np.ascontiguousarray(image[..., 0])
    if size_px is not None and image.shape != (size_px[1], size_px[0]):
        raise InputError(
            f"is {image.shape[1]}x{image.shape[0]} pixels, wanted {size_px[0]}x{size_px[1]}",
            str(path),
            "the strokes belong to another image",
        )
    if image.max() > COLOURS:
        raise InputError(f"contains the id {image.max()}", str(path), _SCRIBBLE_AGAIN)
    return image


def read_labelled(image: Path, strokes: Path | None = None) -> LabelledPicture:
    """An image and its strokes, from NAME_strokes.png or the given file. Raises InputError."""
    pixels = read_image(image)
    size_px = pixels.shape[1], pixels.shape[0]
    return LabelledPicture(pixels, read_strokes(strokes or strokes_path(image), size_px))


def stroke_colours(image: Bytes, strokes: Bytes) -> list[Floats]:
    """Per colour id 1..10 the RGB values (n,3) in 0..1 under its strokes, sloppy ends trimmed.

    image (h,w,3) uint8 BGR; strokes (h,w) uint8. n is 0 for a colour without strokes. Pixels
    where a stroke has run over the border of its patch are outliers of that stroke and left out.
    """
    if image.shape[:2] != strokes.shape:
        raise InputError(f"strokes {strokes.shape} on an image {image.shape[:2]}")
    colours: list[Floats] = []
    for colour in range(1, COLOURS + 1):
        left, top, width, height = cv2.boundingRect((strokes == colour).view(np.uint8))
        if not width:
            colours.append(np.empty((0, 3)))
            continue
        box = np.s_[top : top + height, left : left + width]
        mask = strokes[box] == colour
        count, components = cv2.connectedComponents(mask.view(np.uint8))
        values, part_of = image[box][mask][:, ::-1].astype(float) / 255.0, components[mask]
        parts = [_trim(values[part_of == part]) for part in range(1, count)]
        colours.append(np.concatenate(parts))
    return colours


def stroke_means(image: Bytes, strokes: Bytes) -> tuple[Floats, Floats]:
    """Mean RGB (10,3) in 0..1 under the strokes of each colour, and its pixel count (10,).

    A colour without strokes has count 0 and mean 0.
    """
    colours = stroke_colours(image, strokes)
    counts = np.array([len(values) for values in colours], dtype=float)
    means = np.array([values.mean(axis=0) if len(values) else np.zeros(3) for values in colours])
    return means, counts


def _trim(values: Floats) -> Floats:
    if len(values) < 8:
        return values
    core = round(_CORE_FRACTION * len(values))
    distance2 = ((values - np.median(values, axis=0)) ** 2).sum(axis=1)
    noise = np.eye(3) * _PIXEL_NOISE_VARIANCE
    for _ in range(_CONCENTRATION_STEPS):
        inner = values[np.argsort(distance2, kind="stable")[:core]]
        middle = inner.mean(axis=0)
        off = inner - middle
        covariance = off.T @ off * (_CORE_TO_FULL_VARIANCE / (core - 1)) + noise
        centred = values - middle
        distance2 = (centred * np.linalg.solve(covariance, centred.T).T).sum(axis=1)
    inliers: Floats = values[distance2 < _CHI2_3_AT_0_999]
    return inliers


def _read(path: Path, flags: int) -> Bytes:
    try:
        return decode_picture(
            read_file(path, MOST_FILE_BYTES), flags, most_pixels=MOST_DRAWN_PIXELS
        )
    except MalformedError as error:
        raise InputError(error.what, str(path), "save it again as PNG, with 8 bits") from None
