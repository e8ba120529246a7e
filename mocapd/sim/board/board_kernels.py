"""Light from a printed sheet, ray by ray."""

from typing import NamedTuple

from mocapd.kernels.decorator import kernel
from mocapd.types import Bytes, Floats

MARGIN = 1.0 / 3.0  # of blank paper round the print, in squares


class PixelRays(NamedTuple):
    """Undistorted normalised coordinates of each pixel (h,w,2), and their change to the pixel below and
    to the one at the right."""

    middle: Floats
    down: Floats
    across: Floats


@kernel(error_model="numpy")
def shade_sheet(
    pixels: PixelRays, board_from_ray: Floats, square_m: float,
    print_: Bytes, cells: int, subsamples: int, ink: float, paper: float, blank: float, front: bool,
    cover: Floats, light: Floats,
) -> None:  # fmt: skip
    """Mean over subsamples x subsamples of each pixel: cover (h,w), light (h,w) given back.

    board_from_ray (3,3) gives x, y [m] times inverse depth, and inverse depth. print_ (r,c) 0 ink,
    with `cells` pixels a square; blank is the light of the margin. Not front: all of it is blank.
    """
    rays, down, across = pixels
    columns, rows = print_.shape[1] // cells, print_.shape[0] // cells
    h = board_from_ray
    share = 1.0 / (subsamples * subsamples)
    for j in range(rays.shape[0]):
        for i in range(rays.shape[1]):
            covered, total = 0, 0.0
            for k in range(subsamples * subsamples):
                dy = (k // subsamples + 0.5) / subsamples - 0.5
                dx = (k % subsamples + 0.5) / subsamples - 0.5
                u = rays[j, i, 0] + dy * down[j, i, 0] + dx * across[j, i, 0]
                v = rays[j, i, 1] + dy * down[j, i, 1] + dx * across[j, i, 1]
                w = h[2, 0] * u + h[2, 1] * v + h[2, 2]
                if w <= 1e-9:  # behind the camera
                    continue
                scale = 1.0 / (w * square_m)
                x = (h[0, 0] * u + h[0, 1] * v + h[0, 2]) * scale
                y = (h[1, 0] * u + h[1, 1] * v + h[1, 2]) * scale
                if x <= -MARGIN or y <= -MARGIN or x >= columns + MARGIN or y >= rows + MARGIN:
                    continue
                covered += 1
                if front and 0.0 <= x < columns and 0.0 <= y < rows:
                    dark = print_[int(y * cells), int(x * cells)] == 0
                    total += ink if dark else paper
                else:
                    total += blank
            cover[j, i] = share * covered
            light[j, i] = share * total
