"""Colours of a head and of what is around it: counted, and turned into log odds."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

SIDE = 16  # bins of blue, green and red
CHROMA = 32  # bins of the shares of red and of green
_DARK = 40  # sum of the channels below which their shares mean nothing

Singles = NDArray[np.float32]


@kernel(inline="always")
def colour_bin(b: int, g: int, r: int, gain: float) -> int:
    """Of a colour whose brightness is scaled by gain."""
    i = min(int(b * gain) >> 4, SIDE - 1)
    j = min(int(g * gain) >> 4, SIDE - 1)
    k = min(int(r * gain) >> 4, SIDE - 1)
    return (i * SIDE + j) * SIDE + k


@kernel(inline="always")
def chroma_bin(b: int, g: int, r: int) -> int:
    """Of the shares of red and of green; -1 where it is too dark to tell."""
    total = int(b) + int(g) + int(r)
    if total < _DARK:
        return -1
    return min(int(r) * CHROMA // total, CHROMA - 1) * CHROMA + min(
        int(g) * CHROMA // total, CHROMA - 1
    )


@kernel
def count_head(
    picture: NDArray[np.uint8],
    ellipse: NDArray[np.float64],
    up: NDArray[np.float64],
    gain: float,
    face: float,
    head: Singles,
    around: Singles,
    skin: Singles,
    other: Singles,
) -> None:
    """Add the pixels of picture (H,W,3) BGR to the counts head, around (SIDE^3,), skin, other (CHROMA^2,).

    ellipse (4,): middle x, y, half width, half height [px]; up (2,): the unit vector to the top of the head.
    `head`: up to 0.85 of the outline; `around`: from 1.3 to 2.2 of it, the neck left out; `skin`: the disc of `face`
    times the half width; 0: no face is seen, nothing is counted as skin.
    """
    h, w, _ = picture.shape
    x, y, half_w, half_h = ellipse
    reach = 2.2 * half_h
    # a large head in few steps: some two thousand pixels say as much as more of them
    step = max(1, int(half_w / 12.0))
    for v in range(max(0, int(y - reach)), min(h, int(y + reach) + 1), step):
        for u in range(max(0, int(x - reach)), min(w, int(x + reach) + 1), step):
            dx, dy = u - x, v - y
            across = (dx * -up[1] + dy * up[0]) / half_w
            along = (dx * up[0] + dy * up[1]) / half_h
            rho2 = across * across + along * along
            b, g, r = picture[v, u, 0], picture[v, u, 1], picture[v, u, 2]
            if rho2 < 0.7225:
                head[colour_bin(b, g, r, gain)] += np.float32(1.0)
            elif 1.69 < rho2 < 4.84 and not (along < 0.0 and abs(across) < 0.9):
                around[colour_bin(b, g, r, gain)] += np.float32(1.0)
            else:
                continue
            if face > 0.0:
                c = chroma_bin(b, g, r)
                if c < 0:
                    continue
                if dx * dx + dy * dy < face * face * half_w * half_w:
                    skin[c] += np.float32(1.0)
                elif rho2 > 1.0:
                    other[c] += np.float32(1.0)


@kernel
def blur3(counts: Singles, out: Singles) -> None:
    """Counts (SIDE^3,) spread over neighbouring bins, 1 2 1 along each axis, into out."""
    n = SIDE
    a = counts.copy()
    for axis in range(3):
        stride = 1
        for _ in range(axis):
            stride *= n
        for i in range(n * n * n):
            at = (i // stride) % n
            low = a[i - stride] if at > 0 else a[i]
            high = a[i + stride] if at < n - 1 else a[i]
            out[i] = np.float32(0.25) * (low + high) + np.float32(0.5) * a[i]
        for i in range(n * n * n):
            a[i] = out[i]


@kernel
def log_odds(mine: Singles, others: Singles, floor: float, out: Singles) -> None:
    """Fill out (B,) with the log odds of each bin, from counts (B,), squeezed into -1..1.

    floor: share of all counts that an empty bin is taken to have.
    """
    n = len(mine)
    total_mine, total_others = max(mine.sum(), 1.0), max(others.sum(), 1.0)
    for i in range(n):
        a = mine[i] / total_mine + floor / n
        b = others[i] / total_others + floor / n
        out[i] = np.float32(np.tanh(0.5 * np.log(a / b)))


@kernel
def brightness(picture: NDArray[np.uint8], x0: int, y0: int, x1: int, y1: int) -> float:
    """The mean of all channels, from every fourth pixel each way of the region, which lies in the picture."""
    total = n = 0
    for y in range(y0, y1, 4):
        for x in range(x0, x1, 4):
            total += int(picture[y, x, 0]) + int(picture[y, x, 1]) + int(picture[y, x, 2])
            n += 3
    return total / max(n, 1)


@kernel
def skin_side(
    picture: NDArray[np.uint8], ellipse: NDArray[np.float64], up: NDArray[np.float64], odds: Singles
) -> tuple[float, float]:
    """Share of the head's ellipse (4,) that is skin, and where its middle lies: -1..1 to the picture's right."""
    h, w, _ = picture.shape
    x, y, half_w, half_h = ellipse
    step = max(1, int(half_w / 12.0))
    n = bare = 0
    side = 0.0
    for v in range(max(0, int(y - half_h)), min(h, int(y + half_h) + 1), step):
        for u in range(max(0, int(x - half_w)), min(w, int(x + half_w) + 1), step):
            across = ((u - x) * -up[1] + (v - y) * up[0]) / half_w
            along = ((u - x) * up[0] + (v - y) * up[1]) / half_h
            if across * across + along * along > 0.9:
                continue
            n += 1
            c = chroma_bin(picture[v, u, 0], picture[v, u, 1], picture[v, u, 2])
            if c >= 0 and odds[c] > 0.0:
                bare += 1
                side += across
    return bare / max(n, 1), side / max(bare, 1)
