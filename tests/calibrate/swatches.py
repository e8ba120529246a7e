"""A card of the shirt's ten colours before a grey wall, in a light of choice."""

import numpy as np

from mocapd.shirt.colour.from_pictures import colour_model
from mocapd.types import Bytes, Floats

MODEL = colour_model(())
NAMES = MODEL.names
SIDE_PX = 40
BORDER_PX = 20


def swatches(light: Floats) -> tuple[Bytes, Bytes]:
    """pixels (H,W,3) BGR and strokes (H,W) in the middle of each swatch; light: what it does to RGB (3,)."""
    h, w = 2 * SIDE_PX + 2 * BORDER_PX, 5 * SIDE_PX + 2 * BORDER_PX
    rgb = np.full((h, w, 3), 0.45)
    strokes = np.zeros((h, w), np.uint8)
    for k in range(10):
        y, x = BORDER_PX + SIDE_PX * (k // 5), BORDER_PX + SIDE_PX * (k % 5)
        rgb[y : y + SIDE_PX, x : x + SIDE_PX] = MODEL.mean[k]
        strokes[y + 15 : y + 25, x + 8 : x + 32] = k + 1
    noise = np.random.default_rng(3).normal(0.0, 0.01, rgb.shape)
    seen = np.clip(rgb * light + noise, 0.0, 1.0)
    return np.ascontiguousarray((255 * seen).round().astype(np.uint8)[..., ::-1]), strokes


def swapped(strokes: Bytes, a: int, b: int) -> Bytes:
    """Strokes with two colours exchanged."""
    out = strokes.copy()
    out[strokes == a], out[strokes == b] = b, a
    return out
