"""Colour classification of pixels, exact (paper §5.2 steps 1 and 3).

It looks at the samples pixels[y0 + stride i, x0 + stride j] of a whole frame, for (i,j) over the shape of `out`, which the
caller places inside the frame. `mask` may be coarser than the frame by a power of two: it is read at [y >> mask_shift,
x >> mask_shift], and 0 is background.
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

UInt8 = NDArray[np.uint8]
Float32 = NDArray[np.float32]


@kernel
def classify(
    pixels_bgr: UInt8,
    mask: UInt8,
    mask_shift: int,
    upper: Float32,
    offset: Float32,
    distance_px: Float32,
    prior_per_px: float,
    threshold: float,
    x0: int,
    y0: int,
    stride: int,
    out: UInt8,
) -> tuple[int, int]:
    """Write the id 1..10 of the nearest colour within `threshold` [standard deviations], else 0.

    To the distance of a colour comes the cost C d of lying d away from where the pose shows it (step 3): distance_px
    (10,h,w) on the grid of `out`, in the unit that `prior_per_px` (C, 6 / s in the paper) is per, 0 in step 1.
    pixels_bgr (H,W,3); upper (10,3,3) and offset (10,3) of `colour_model.fold`; out (h,w). Returns the counts of
    classified and of foreground samples.
    """
    classified = 0
    foreground = 0
    for i in range(out.shape[0]):
        row = pixels_bgr[y0 + stride * i]
        mask_row = mask[(y0 + stride * i) >> mask_shift]
        for j in range(out.shape[1]):
            x = x0 + stride * j
            out[i, j] = 0
            if mask_row[x >> mask_shift] == 0:
                continue
            foreground += 1
            b = np.float32(row[x, 0])
            g = np.float32(row[x, 1])
            r = np.float32(row[x, 2])
            best_id = np.uint8(0)
            best = np.float32(threshold)
            for k in range(upper.shape[0]):
                penalty = np.float32(prior_per_px) * distance_px[k, i, j]
                room = best - penalty
                if room <= 0.0:
                    continue
                room *= room
                z2 = upper[k, 2, 2] * r + offset[k, 2]
                distance2 = z2 * z2
                if distance2 >= room:
                    continue
                z1 = upper[k, 1, 1] * g + upper[k, 1, 2] * r + offset[k, 1]
                distance2 += z1 * z1
                if distance2 >= room:
                    continue
                z0 = upper[k, 0, 0] * b + upper[k, 0, 1] * g + upper[k, 0, 2] * r + offset[k, 0]
                distance2 += z0 * z0
                if distance2 < room:
                    best = penalty + np.sqrt(distance2)
                    best_id = np.uint8(k + 1)
            out[i, j] = best_id
            classified += int(best_id > 0)
    return classified, foreground
