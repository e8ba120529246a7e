"""Image files for the page: strokes as grey PNG of colour ids, frozen pictures as JPEG, previews as PNG."""

import base64

import cv2
import numpy as np

from mocapd.boundary.image_decoding import decode_picture
from mocapd.errors import InputError, MalformedError
from mocapd.shirt.standard_shirt import N_COLOURS, standard_shirt
from mocapd.types import Bytes

_ROOM = 0.35  # brightness of everything but the shirt
_RELOAD = "reload the page and draw again"


def decode_strokes(png_base64: str, size_px: tuple[int, int], camera: str) -> Bytes:
    """Strokes (h,w) 0..10 of an 8-bit grey PNG (or one in colour whose channels agree) in base64.

    size_px: width and height of the camera's frozen picture. Raises InputError.
    """
    try:
        data = base64.b64decode(png_base64, validate=True)
    except ValueError:  # letters beyond ASCII; binascii.Error is one too
        raise InputError("the strokes are no base64", camera, _RELOAD) from None
    try:
        image = decode_picture(data, cv2.IMREAD_UNCHANGED, size_px)
    except MalformedError as error:
        raise InputError(f"the picture of the strokes {error}", camera, _RELOAD) from None
    if image.ndim == 3:
        if (image[..., :3] != image[..., :1]).any():
            raise InputError("the strokes are painted in colours, not in ids", camera, _RELOAD)
        image = image[..., 0]
    if image.max() > N_COLOURS:
        raise InputError(f"there is no colour {image.max()}", camera, _RELOAD)
    return np.ascontiguousarray(image, dtype=np.uint8)


def encode_strokes(strokes: Bytes) -> bytes:
    """Strokes (h,w) as an 8-bit grey PNG."""
    return _encode(".png", strokes, [cv2.IMWRITE_PNG_COMPRESSION, 3])


def encode_picture(pixels: Bytes) -> bytes:
    """A frozen picture (h,w,3) BGR as JPEG, good enough to draw on."""
    return _encode(".jpg", pixels, [cv2.IMWRITE_JPEG_QUALITY, 90])


def encode_preview(pixels: Bytes, ids: Bytes) -> bytes:
    """Pixels that read as the shirt, ids (h,w), in the standard's colours over the dimmed picture (h,w,3) BGR, as PNG."""
    grey = cv2.cvtColor(pixels, cv2.COLOR_BGR2GRAY)
    shown = np.repeat((_ROOM * grey).astype(np.uint8)[..., None], 3, axis=2)
    palette = np.zeros((N_COLOURS + 1, 3), np.uint8)
    palette[1:] = standard_shirt().srgb[:, ::-1]
    shown[ids > 0] = palette[ids[ids > 0]]
    return _encode(".png", shown, [cv2.IMWRITE_PNG_COMPRESSION, 3])


def _encode(kind: str, image: Bytes, options: list[int]) -> bytes:
    done, data = cv2.imencode(kind, image, options)
    assert done, f"cv2 cannot write {kind}"
    return data.tobytes()
