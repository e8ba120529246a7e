"""The static background of one camera: learned beside the body, followed when its light jumps."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel


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
