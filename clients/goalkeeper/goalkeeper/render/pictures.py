"""Pictures for textures, drawn by numbers: (height,width,4) uint8 RGBA, row 0 on top. Pure."""

import numpy as np

from mocapd.types import Bytes, Floats

_SEED = 7


def _rgba(colour: Floats, alpha: Floats | float = 1.0) -> Bytes:
    """Colour (h,w,3) and alpha (h,w), both 0..1."""
    h, w, _ = colour.shape
    out = np.empty((h, w, 4))
    out[..., :3] = colour
    out[..., 3] = alpha
    picture: Bytes = np.rint(255 * np.clip(out, 0.0, 1.0)).astype(np.uint8)
    return picture


def grass(size: int = 256) -> Bytes:
    """A square with a light and a dark stripe, side by side; it tiles."""
    rng = np.random.default_rng(_SEED)
    noise = rng.normal(0.0, 1.0, (size, size))
    blades = sum(np.roll(noise, k, axis=0) for k in range(4)) / 4.0
    stripe = np.where(np.arange(size) < size // 2, 0.075, 0.0)[None, :]
    light = 1.0 + stripe * 2.2 + 0.16 * blades
    base = np.array([0.105, 0.36, 0.115])
    return _rgba(base * light[..., None])


def crowd(seed: int, size: tuple[int, int] = (512, 128)) -> Bytes:
    """Rows of people on seats, in shirts of two clubs and their own; it tiles sideways."""
    w, h = size
    rng = np.random.default_rng([_SEED, seed])
    picture = np.full((h, w, 3), 0.055) * np.array([0.8, 0.85, 1.1])
    clubs = np.array(
        [[0.85, 0.42, 0.08], [0.10, 0.30, 0.70], [0.85, 0.85, 0.85], [0.7, 0.12, 0.12]]
    )
    rows, per_row = 8, w // 9
    for row in range(rows):
        top = row * (h // rows)
        for seat in range(per_row):
            if rng.random() < 0.08:
                continue
            x = int(seat * w / per_row + rng.integers(0, 3)) % (w - 7)
            up = int(rng.integers(0, 4))
            shirt = clubs[rng.integers(4)] if rng.random() < 0.65 else rng.uniform(0.1, 0.6, 3)
            skin = np.array([0.75, 0.56, 0.45]) * rng.uniform(0.45, 1.0)
            light = rng.uniform(0.55, 0.85)
            picture[top + 8 - up : top + 16 - up, x : x + 7] = shirt * light
            picture[top + 3 - up : top + 8 - up, x + 1 : x + 6] = skin * light
            picture[max(top + 2 - up, 0) : top + 4 - up, x + 1 : x + 6] = rng.uniform(0.03, 0.2)
    return _rgba(picture)


def spot(size: int = 64, hardness: float = 1.5) -> Bytes:
    """White, round, and ever fainter outwards: glow and shadow by their colour."""
    at = (np.arange(size) - size / 2 + 0.5) / (size / 2)
    radius = np.hypot(at[:, None], at[None, :])
    return _rgba(np.ones((size, size, 3)), np.clip(1.0 - radius, 0.0, 1.0) ** hardness)


def ball(size: int = 128) -> Bytes:
    """The classic one, unrolled: white with twelve dark pentagons and seams; width is twice its height."""
    up = np.pi * (0.5 - (np.arange(size) + 0.5) / size)[:, None]
    around = 2 * np.pi * (np.arange(2 * size) + 0.5)[None, :] / (2 * size)
    way = np.stack(
        [np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.sin(up) + 0 * around], axis=-1
    )
    g = (1 + 5**0.5) / 2
    corners = np.array(
        [p for a in (-1, 1) for b in (-g, g) for p in ((0, a, b), (a, b, 0), (b, 0, a))]
    ) / np.hypot(1, g)
    near = np.sort(way @ corners.T, axis=-1)
    dark = near[..., -1] > 0.928
    seam = (near[..., -1] - near[..., -2] < 0.02) & ~dark
    colour = np.where(dark[..., None], 0.06, np.where(seam[..., None], 0.62, 0.96))
    return _rgba(colour * np.ones(3))


def sky(size: int = 128) -> Bytes:
    """Dusk: from a warm horizon at the bottom to night; 8 px wide."""
    up = np.linspace(1.0, 0.0, size)[:, None, None]
    night, blue, warm = (
        np.array(c) for c in ((0.012, 0.02, 0.06), (0.05, 0.10, 0.26), (0.52, 0.30, 0.26))
    )
    low = np.clip(1.0 - up / 0.35, 0.0, 1.0) ** 1.6
    high = np.clip((up - 0.25) / 0.75, 0.0, 1.0)
    colour = (1 - low) * ((1 - high) * blue + high * night) + low * warm
    return _rgba(np.broadcast_to(colour, (size, 8, 3)))
