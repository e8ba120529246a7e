"""Procedural surfaces of the room: albedo as a function of the place on it."""

import numpy as np

from mocapd.kernels.decorator import kernel
from mocapd.sim.person.face_kernels import portrait
from mocapd.types import Floats


@kernel
def hash01(x: int, y: int | np.int64, seed: int) -> float:
    """A number 0..1 that depends on three integers alone (two rounds of the Murmur3 finaliser)."""
    h = np.uint32(x) * np.uint32(0x9E3779B1) ^ np.uint32(y) * np.uint32(0x85EBCA77)
    h = np.uint32(h ^ (np.uint32(seed) * np.uint32(0xC2B2AE3D)))
    for _ in range(2):
        h = np.uint32(h ^ (h >> np.uint32(16)))
        h = np.uint32(h * np.uint32(0x85EBCA6B))
        h = np.uint32(h ^ (h >> np.uint32(13)))
        h = np.uint32(h * np.uint32(0xC2B2AE35))
    return np.float64(np.uint32(h ^ (h >> np.uint32(16)))) / 4294967296.0


@kernel
def value_noise(u: float, v: float, seed: int) -> float:
    """Smooth noise 0..1 with features of size 1."""
    iu, iv = int(np.floor(u)), int(np.floor(v))
    fu, fv = u - iu, v - iv
    fu, fv = fu * fu * (3 - 2 * fu), fv * fv * (3 - 2 * fv)
    a = hash01(iu, iv, seed) * (1 - fu) + hash01(iu + 1, iv, seed) * fu
    b = hash01(iu, iv + 1, seed) * (1 - fu) + hash01(iu + 1, iv + 1, seed) * fu
    return a * (1 - fv) + b * fv


@kernel
def _poster(u: float, v: float, seed: int, rgb: Floats) -> None:
    """Discs and a stripe of strong colours on paper; u, v in 0..1 over the sheet."""
    for k in range(7):
        cu, cv = hash01(k, np.int64(1), seed), hash01(k, np.int64(2), seed)
        radius = 0.10 + 0.22 * hash01(k, np.int64(3), seed)
        if (u - cu) ** 2 + 1.8 * (v - cv) ** 2 < radius * radius:
            for c in range(3):
                rgb[c] = 0.04 + 0.75 * hash01(k, 4 + c, seed) ** 2
    if 0.08 < v < 0.14 and 0.1 < u < 0.9:
        for c in range(3):
            rgb[c] = 0.05
    if u < 0.04 or u > 0.96 or v < 0.03 or v > 0.97:
        for c in range(3):
            rgb[c] = 0.75


@kernel
def pattern_albedo(
    pattern: int, u_m: float, v_m: float, u: float, v: float, seed: int, rgb: Floats
) -> None:
    """Turns the plain albedo rgb (3,), in place, into the pattern's at (u_m, v_m) [m] = (u, v) in 0..1."""
    factor = 1.0
    if pattern == 1:  # plaster: blotches and grain
        factor = 0.86 + 0.16 * value_noise(5 * u_m, 5 * v_m, seed)
        factor += 0.10 * (value_noise(60 * u_m, 60 * v_m, seed + 1) - 0.5)
    elif pattern == 2:  # planks along v, 0.14 m wide, with gaps and grain
        plank = int(np.floor(u_m / 0.14))
        factor = 0.75 + 0.4 * hash01(plank, int(np.floor(v_m / 1.1 + 0.37 * plank)), seed)
        factor *= 0.85 + 0.3 * value_noise(70 * u_m, 5 * v_m, seed + 2)
        if u_m / 0.14 - plank < 0.03:
            factor *= 0.45
    elif pattern == 3:  # checks of 0.08 m
        if (int(np.floor(u_m / 0.08)) + int(np.floor(v_m / 0.08))) % 2 == 0:
            factor = 0.35
    elif pattern == 4:  # grass and leaves
        factor = 0.35 + 0.8 * value_noise(9 * u_m, 9 * v_m, seed)
        factor *= 0.6 + 0.8 * value_noise(70 * u_m, 70 * v_m, seed + 3)
    elif pattern == 5:  # bricks of 0.24 x 0.08 m with mortar
        row = int(np.floor(v_m / 0.08))
        along = u_m / 0.24 + 0.5 * (row % 2)
        brick = int(np.floor(along))
        factor = 0.75 + 0.45 * hash01(brick, row, seed)
        if along - brick < 0.05 or v_m / 0.08 - row < 0.13:
            factor = 1.0
            for c in range(3):
                rgb[c] = 0.35
        factor *= 0.9 + 0.2 * value_noise(50 * u_m, 50 * v_m, seed + 1)
    elif pattern == 6:
        _poster(u, v, seed, rgb)
    elif pattern == 7:
        portrait(u, v, rgb)
    for c in range(3):
        rgb[c] *= factor
