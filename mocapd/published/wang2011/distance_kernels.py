"""Exact Euclidean distance to the nearest sample of each colour, and which sample that is.

Felzenszwalb and Huttenlocher, "Distance Transforms of Sampled Functions" (2012): a pass along the
columns, then the lower envelope of parabolas along each row. Work is bounded to the box around a
colour, grown by the truncation.
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.kernels.decorator import kernel

NO_SAMPLE = -1


@kernel
def bounding_boxes(ids: NDArray[np.uint8], boxes: NDArray[np.int64]) -> None:
    """boxes (11,4): x0, y0, x1, y1 (inclusive) of each id 0..10; x1 < x0 for an absent one."""
    h, w = ids.shape
    for k in range(boxes.shape[0]):
        boxes[k, 0], boxes[k, 1], boxes[k, 2], boxes[k, 3] = w, h, -1, -1
    for y in range(h):
        x = 0
        while x < w:
            k = ids[y, x]
            first = x
            while x < w and ids[y, x] == k:
                x += 1
            box = boxes[k]
            box[0], box[1] = min(box[0], first), min(box[1], y)
            box[2], box[3] = max(box[2], x - 1), y


@kernel
def nearest_rows(
    ids: NDArray[np.uint8], k: int, box: NDArray[np.int64], y0: int, y1: int, out: NDArray[np.int32]
) -> None:
    """out[y0:y1, x0:x1+1]: the row of the nearest sample of id k in the same column, or NO_SAMPLE."""
    x0, x1 = box[0], box[2] + 1
    for x in range(x0, x1):
        out[y0, x] = y0 if ids[y0, x] == k else NO_SAMPLE
    for y in range(y0 + 1, y1):
        for x in range(x0, x1):
            out[y, x] = y if ids[y, x] == k else out[y - 1, x]
    for y in range(y1 - 2, y0 - 1, -1):
        for x in range(x0, x1):
            below = out[y + 1, x]
            here = out[y, x]
            if below != NO_SAMPLE and (here == NO_SAMPLE or below - y < y - here):
                out[y, x] = below


@kernel
def distance_maps(
    ids: NDArray[np.uint8],
    limit_px: float,
    distance_px: NDArray[np.float32],
    nearest_yx: NDArray[np.int16],
) -> None:
    """distance_px (10,h,w): from each sample of `ids` (h,w) to the nearest of id k + 1 [samples].

    Truncated at `limit_px`, which is also the value where the colour is absent; nearest_yx
    (10,h,w,2): row and column of that nearest sample, NO_SAMPLE where the distance is truncated.
    """
    h, w = ids.shape
    nearest_row = np.empty((h, w), dtype=np.int32)
    boxes = np.empty((distance_px.shape[0] + 1, 4), dtype=np.int64)
    columns = np.empty(w, dtype=np.int32)  # parabolas of the lower envelope
    begins = np.empty(w + 1, dtype=np.float32)  # where each begins to be the lowest
    heights = np.empty(w, dtype=np.float32)
    limit2 = np.float32(limit_px * limit_px)
    reach = int(min(np.ceil(limit_px), h + w))
    bounding_boxes(ids, boxes)
    distance_px[:] = np.float32(limit_px)
    nearest_yx[:] = NO_SAMPLE
    for k in range(distance_px.shape[0]):
        box = boxes[k + 1]
        if box[2] < box[0]:
            continue
        y0, y1 = max(0, box[1] - reach), min(h, box[3] + reach + 1)
        nearest_rows(ids, k + 1, box, y0, y1, nearest_row)
        for y in range(y0, y1):
            rows = nearest_row[y]
            count = 0
            for x in range(box[0], box[2] + 1):
                if rows[x] == NO_SAMPLE:
                    continue
                height = np.float32((y - rows[x]) * (y - rows[x]))
                if height >= limit2:
                    continue
                begin = np.float32(-1e9)
                while count > 0:
                    last = columns[count - 1]
                    across2 = np.float32(x * x - last * last)
                    begin = (height - heights[count - 1] + across2) / np.float32(2 * (x - last))
                    if begin > begins[count - 1]:
                        break
                    count -= 1
                    begin = np.float32(-1e9)
                columns[count] = x
                heights[count] = height
                begins[count] = begin
                count += 1
            if count == 0:
                continue
            begins[count] = np.float32(1e9)
            part = 0
            first, last = columns[0], columns[count - 1]
            for x in range(max(0, first - reach), min(w, last + reach + 1)):
                while begins[part + 1] < x:
                    part += 1
                across = x - columns[part]
                distance2 = heights[part] + np.float32(across * across)
                if distance2 < limit2:
                    distance_px[k, y, x] = np.sqrt(distance2)
                    nearest_yx[k, y, x, 0] = rows[columns[part]]
                    nearest_yx[k, y, x, 1] = columns[part]
