"""Colours of rings along the body's parts, where they are seen."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.published.hecht2009.cylinders.occlusion_kernels import OcclusionModel, is_hidden

Array = NDArray[np.float64]
Bytes = NDArray[np.uint8]
Singles = NDArray[np.float32]


@kernel(error_model="numpy")
def observe_colours(
    quads: Array,
    depths: Array,
    colour: Bytes,
    mask: Bytes,
    occlusion: OcclusionModel,
    grid: tuple[int, int],
    hidden_by_m: float,
    mean: Singles,
    share: Array,
) -> None:
    """Mean colour (C,R,3) and share (C,R) of the samples that count, of R rings along each of C parts.

    quads (C,4,2), depths (C,2), NaN: not in the picture; a sample counts inside of the picture where mask (h,w) is not
    0 and no other part hides it; grid: samples of a ring along and across. Where none counts the mean is 0.
    """
    along, across = grid
    h, w = mask.shape
    rings = mean.shape[1]
    for c in range(quads.shape[0]):
        others = ~(1 << c)
        quad = quads[c]
        for r in range(rings):
            blue = green = red = 0.0
            count = 0
            for j in range(along):
                s = (r + (j + 0.5) / along) / rings
                ax = (1.0 - s) * quad[0, 0] + s * quad[1, 0]
                ay = (1.0 - s) * quad[0, 1] + s * quad[1, 1]
                bx = (1.0 - s) * quad[3, 0] + s * quad[2, 0]
                by = (1.0 - s) * quad[3, 1] + s * quad[2, 1]
                depth = (1.0 - s) * depths[c, 0] + s * depths[c, 1]
                for k in range(across):
                    f = (k + 0.5) / across
                    x, y = ax + f * (bx - ax), ay + f * (by - ay)
                    if not (x >= -0.5 and x < w - 0.5 and y >= -0.5 and y < h - 0.5):
                        continue
                    pixel = colour[int(y + 0.5), int(x + 0.5)]
                    if mask[int(y + 0.5), int(x + 0.5)] == 0:
                        continue
                    if is_hidden(occlusion, others, x, y, depth, hidden_by_m):
                        continue
                    blue += pixel[0]
                    green += pixel[1]
                    red += pixel[2]
                    count += 1
            share[c, r] = count / (along * across)
            f = 1.0 / max(count, 1)
            mean[c, r, 0], mean[c, r, 1], mean[c, r, 2] = f * blue, f * green, f * red
