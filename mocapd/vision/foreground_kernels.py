"""Learning a background; what stands before a known one, and its shadow; and the floor about a person."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

BACKGROUND, BEFORE, UNKNOWN, SHADOW, CLOTH_OR_SHADOW = 0, 1, 2, 3, 4


@kernel
def stands_before(
    picture: NDArray[np.uint8],
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    left: int,
    top: int,
    known: int,
    tolerance: float,
    sure: tuple[float, float],
    likely: tuple[float, float],
    out: NDArray[np.uint8],
) -> None:
    """out (h,w), of a part of the picture that begins at `left` and `top`: UNKNOWN where the background was seen fewer than
    `known` times, BEFORE where a channel differs from it by more than `tolerance`, BACKGROUND elsewhere.

    picture (H,W,3); mean (H,W,3) 0..255 and age (H,W) of the background. A shadow is the background dimmed in all channels
    alike (Horprasert et al. 1999): `sure` and `likely` are to which share at least, and how far the colour may then be off.
    A sure one is SHADOW, where cloth of the background's colour is seldom, a likely one CLOTH_OR_SHADOW.
    """
    h, w = out.shape
    for y in range(h):
        seen, usual = picture[top + y, left : left + w], mean[top + y, left : left + w]
        looks = age[top + y, left : left + w]
        for x in range(w):
            if looks[x] < known:
                out[y, x] = UNKNOWN
                continue
            most = np.float32(0.0)
            for c in range(3):
                most = max(most, abs(np.float32(seen[x, c]) - usual[x, c]))
            if most <= tolerance:
                out[y, x] = BACKGROUND
                continue
            along, length2 = np.float32(0.0), np.float32(1.0)
            for c in range(3):
                a, m = np.float32(seen[x, c]), usual[x, c]
                along += a * m
                length2 += m * m
            share = along / length2
            out[y, x] = BEFORE
            if share >= 1.0 or share < likely[0]:
                continue
            off = np.float32(0.0)
            for c in range(3):
                off = max(off, abs(np.float32(seen[x, c]) - share * usual[x, c]))
            if share > sure[0] and off < sure[1]:
                out[y, x] = SHADOW
            elif off < likely[1]:
                out[y, x] = CLOTH_OR_SHADOW


@kernel
def label_cleaned(
    first: NDArray[np.uint8],
    cleaned: NDArray[np.uint8],
    left: int,
    top: int,
    out: NDArray[np.uint8],
) -> None:
    """out (H,W), in the part that begins at `left` and `top`: what `stands_before` said first (h,w), where `cleaned` (h,w) is
    not 0, and BEFORE where that was BACKGROUND; UNKNOWN stays."""
    h, w = first.shape
    for y in range(h):
        line = out[top + y, left : left + w]
        for x in range(w):
            k = first[y, x]
            there = k if k >= SHADOW else np.uint8(BEFORE)
            there = there if cleaned[y, x] != 0 else np.uint8(BACKGROUND)
            line[x] = k if k == UNKNOWN else there


def stands(before: NDArray[np.uint8]) -> NDArray[np.bool_]:
    """(h,w): where something is, or throws a shadow, before a background that is known."""
    there: NDArray[np.bool_] = (before != BACKGROUND) & (before != UNKNOWN)
    return there


@kernel
def near_on_floor(
    met_x: NDArray[np.float32],
    met_z: NDArray[np.float32],
    left: int,
    top: int,
    x_m: float,
    z_m: float,
    reach_m: float,
    out: NDArray[np.uint8],
) -> None:
    """out (h,w), of a part of the picture that begins at `left` and `top`: 1 where a pixel meets the floor at met_x, met_z
    (H,W) [m] within reach_m of x_m, z_m, else 0."""
    h, w = out.shape
    x0, z0 = np.float32(x_m), np.float32(z_m)
    reach2 = np.float32(reach_m * reach_m)
    for y in range(h):
        xs, zs = met_x[top + y, left : left + w], met_z[top + y, left : left + w]
        for x in range(w):
            across, along = xs[x] - x0, zs[x] - z0
            is_near = across * across + along * along < reach2
            out[y, x] = np.uint8(1) if is_near else np.uint8(0)


@kernel
def learn_background(
    picture: NDArray[np.uint8],
    body: NDArray[np.uint8],
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    rate: float,
    phase: int,
    step: int,
) -> None:
    """Follow each pixel's colour where `body` (h,w) is 0. mean (h,w,3) 0..255; age (h,w) counts looks.

    Only rows y with y % step == phase are visited: the background changes slowly.
    """
    h, w, _ = picture.shape
    share = np.empty(3 * w, np.float32)
    slow, one = np.float32(rate), np.float32(1.0)
    for y in range(phase, h, step):
        for x in range(w):
            f = np.float32(0.0)
            if body[y, x] == 0:
                a = age[y, x]
                f = slow if a == 255 else max(slow, one / (np.float32(a) + one))
                if a < 255:
                    age[y, x] = a + 1
            share[3 * x] = f
            share[3 * x + 1] = f
            share[3 * x + 2] = f
        # a plain loop over the row, which the compiler turns into vector instructions
        old, new = mean[y].reshape(3 * w), picture[y].reshape(3 * w)
        for i in range(3 * w):
            old[i] += share[i] * (np.float32(new[i]) - old[i])


@kernel
def learn_unknown(
    picture: NDArray[np.uint8],
    body: NDArray[np.uint8],
    known: int,
    tolerance: float,
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
) -> None:
    """Learn colours that were seen fewer than `known` times in a row, where `body` (h,w) is 0; a look that differs from them
    by more than tolerance, 0..255, in a channel begins anew. Shapes as of `learn_background`."""
    h, w = body.shape
    one = np.float32(1.0)
    for y in range(h):
        for x in range(w):
            if body[y, x] != 0 or age[y, x] >= known:
                continue
            for c in range(3):
                if abs(np.float32(picture[y, x, c]) - mean[y, x, c]) > tolerance:
                    age[y, x] = 0
            share = one / (np.float32(age[y, x]) + one)
            for c in range(3):
                mean[y, x, c] += share * (np.float32(picture[y, x, c]) - mean[y, x, c])
            age[y, x] += 1


@kernel
def changed(
    picture: NDArray[np.uint8],
    body: NDArray[np.uint8],
    mean: NDArray[np.float32],
    age: NDArray[np.uint8],
    tolerance: float,
) -> float:
    """Share of the known background, body left out, that no longer looks as learned, from every 24th pixel."""
    h, w, _ = picture.shape
    n = different = 0
    tol = np.float32(tolerance * 255.0)
    for y in range(0, h, 6):
        for x in range(0, w, 4):
            if body[y, x] != 0 or age[y, x] < 6:
                continue
            n += 1
            for c in range(3):
                if abs(np.float32(picture[y, x, c]) - mean[y, x, c]) > tol:
                    different += 1
                    break
    return different / max(n, 1)
