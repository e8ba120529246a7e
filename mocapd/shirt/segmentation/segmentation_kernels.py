"""What the classified picture says of the colours: statistics, counts, agreement with the pose."""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel
from mocapd.shirt.segmentation.cell_kernels import bin_of

Array = NDArray[np.float64]


@kernel
def count_colours(
    picture: NDArray[np.uint8],
    x0: int,
    y0: int,
    body: NDArray[np.uint8],
    model_ids: NDArray[np.uint8],
    image_ids: NDArray[np.uint8],
    pixel_weight: NDArray[np.uint8],
    shirt_count: NDArray[np.float32],
    other_count: NDArray[np.float32],
) -> None:
    """Count colours seen on the shirt, and on moving things outside of `body` (H,W), the widened shirt."""
    h, w = model_ids.shape
    for y in range(0, h, 2):
        for x in range(0, w, 2):
            k = model_ids[y, x]
            if k > 0:
                if image_ids[y, x] == k:
                    shirt_count[bin_of(picture[y0 + y, x0 + x])] += 1.0
            elif pixel_weight[y, x] != 255 and body[y0 + y, x0 + x] == 0:
                other_count[bin_of(picture[y0 + y, x0 + x])] += 1.0


@kernel
def colour_statistics(
    picture: NDArray[np.uint8],
    x0: int,
    y0: int,
    model_ids: NDArray[np.uint8],
    image_ids: NDArray[np.uint8],
    only_classified: bool,
    sums: Array,
) -> None:
    """Add up the colours inside the rendered patches: sums (10,4) = n, b, g, r [0..1].

    A pixel counts when it and its four neighbours were rendered with one colour, and, when
    `only_classified`, the picture was classified so too.
    """
    h, w = model_ids.shape
    for y in range(1, h - 1):
        for x in range(1, w - 1):
            k = model_ids[y, x]
            if k == 0:
                continue
            if only_classified and image_ids[y, x] != k:
                continue
            if (
                model_ids[y - 1, x] != k
                or model_ids[y + 1, x] != k
                or model_ids[y, x - 1] != k
                or model_ids[y, x + 1] != k
            ):
                continue
            b = picture[y0 + y, x0 + x, 0] / 255.0
            g = picture[y0 + y, x0 + x, 1] / 255.0
            r = picture[y0 + y, x0 + x, 2] / 255.0
            s = sums[k - 1]
            s[0] += 1.0
            s[1] += b
            s[2] += g
            s[3] += r


@kernel
def agreement(model_ids: NDArray[np.uint8], image_ids: NDArray[np.uint8]) -> tuple[int, int]:
    """How many rendered pixels there are, and at how many the picture was given the same colour."""
    h, w = model_ids.shape
    n = same = 0
    for y in range(h):
        for x in range(w):
            if model_ids[y, x] > 0:
                n += 1
                if image_ids[y, x] == model_ids[y, x]:
                    same += 1
    return n, same
