"""One camera's segmentation: background hint, histogram search, classification, white balance. [sections 4, 5.2]"""

from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.published.wang2011.chrominance import histogram_search
from mocapd.published.wang2011.classify_kernels import classify
from mocapd.published.wang2011.drawing import Grid, PatchRenderer
from mocapd.published.wang2011.mog_background import BackgroundSubtractor, mask_size
from mocapd.published.wang2011.params import Params
from mocapd.shirt.colour.colour_model import ColourModel, fold
from mocapd.shirt.colour.white_balance import (
    remember_illumination,
    shade_precision,
    solve_white_balance,
)
from mocapd.shirt.pose_database.idmap_crop_kernels import crop_id_map
from mocapd.types import Bytes, Camera, Floats, Ints, Singles
from mocapd.vision.raster_kernels import label_triangles

_CROSS = cv2.getStructuringElement(cv2.MORPH_CROSS, (3, 3))


@dataclass(frozen=True, slots=True, eq=False)
class Sight:
    """What step 1 saw: ids (h,w) on `grid`; size_px: s, the side of the square cut out around
    the shirt; map40 (40,40) with its scale [px per cell] and centre_px (2,); mask and mask_shift as
    the classifiers take them."""

    ids: Bytes
    grid: Grid
    size_px: float
    map40: Bytes
    map_scale: float
    centre_px: Floats
    mask: Bytes
    mask_shift: int


class Wang2011Segmenter:
    """Evidence of one camera. Keeps the background, W and the reference illuminations."""

    def __init__(self, camera: Camera, colours: ColourModel, W: Floats, params: Params) -> None:
        self.camera, self.params = camera, params
        self.colours = colours.tolerating(params.shading_sigma, params.noise_sigma)
        self._first_W = W
        self._precision = shade_precision(self.colours)
        self._background = BackgroundSubtractor(params.background)
        self.reset()

    def reset(self) -> None:
        """Forget all but the first white balance."""
        self.W = self._first_W
        self.references: tuple[Floats, ...] = (self._first_W,)
        self._background.reset()
        self._body: Bytes | None = None

    def look(self, pixels: Bytes) -> Sight | None:
        """Step 1: find the shirt and classify its colours; None where hardly anything is coloured."""
        params = self.params
        mask, shift = self._background.apply(pixels), params.background.shift
        if self._body is not None:
            mask = np.maximum(mask, self._body)  # a motionless person fades into the background
        if np.count_nonzero(mask) < params.min_foreground * mask.size:
            mask, shift = np.ones((1, 1), np.uint8), 31
        found = histogram_search(pixels, mask, shift, params.histogram)
        if found.u_max == 0.0:
            return None
        grid = self._grid(found.x_px, found.y_px, params.crop * found.s_px)
        ids, coloured, foreground = self._classify(
            pixels, mask, shift, grid, self.W, params.threshold
        )
        if params.adaptive_white_balance and coloured < params.poor_classification * foreground:
            for W in self.references:
                other, n, _ = self._classify(pixels, mask, shift, grid, W, params.threshold)
                if n > coloured:
                    self.W, ids, coloured = W, other, n
        map40, scale, centre = crop_id_map(ids)
        if coloured < params.min_samples or not map40.any():
            return None
        return Sight(
            ids, grid, scale * grid.stride * len(map40), map40, scale * grid.stride, grid.to_pixels(np.array(centre)),
            mask, shift,
        )  # fmt: skip

    def refine(self, pixels: Bytes, sight: Sight, distance: Singles) -> Bytes:
        """Step 3: ids (h,w) with the pose as prior; distance (10,h,w) [samples] to its colours."""
        params, grid = self.params, sight.grid
        per_sample = params.prior_weight / sight.size_px * grid.stride
        prior = params.prior_threshold, distance, per_sample
        return self._classify(pixels, sight.mask, sight.mask_shift, grid, self.W, *prior)[0]

    def learn(
        self, pixels: Bytes, grid: Grid, drawing: PatchRenderer, colour: Bytes, refined: Bytes
    ) -> None:
        """Step 5: W for the next frame from the final pose, and a reference if the light is new.

        Only samples that step 3 classified as the pose shows them are learned from (`refined` (h,w)):
        the rest, where the pose is off, would teach W the colours of neighbouring patches.
        """
        params = self.params
        self._remember_body(grid, drawing)
        if not params.adaptive_white_balance:
            return
        ids = np.empty(drawing.triangle_at.shape, np.uint8)
        label_triangles(drawing.triangle_at, colour, ids)
        same = cv2.dilate(ids, _CROSS) == cv2.erode(ids, _CROSS)
        same[[0, -1]] = same[:, [0, -1]] = False
        means, counts = mean_colours(
            grid.sampled(pixels), np.where(same & (ids == refined), ids, 0)
        )
        if counts.sum() == 0:
            return
        # hue is believed more than brightness, so that a patch in shade does not brighten the rest
        self.W = solve_white_balance(
            means, self.colours.mean, np.sqrt(counts), prior=self.W, precision=self._precision
        )
        self.references = remember_illumination(self.references, self.W, params.new_illumination)

    def forget_body(self) -> None:
        """Nobody is tracked any more: the background hint alone says what is foreground."""
        self._body = None

    def _grid(self, x_px: float, y_px: float, side_px: float) -> Grid:
        width, height = self.camera.size_px
        x0, x1 = (int(np.clip(x_px + s * 0.5 * side_px, 0, width)) for s in (-1, 1))
        y0, y1 = (int(np.clip(y_px + s * 0.5 * side_px, 0, height)) for s in (-1, 1))
        n = self.params.stride_px
        return Grid(x0, y0, max((x1 - x0) // n, 1), max((y1 - y0) // n, 1), n)

    def _classify(
        self, pixels: Bytes, mask: Bytes, shift: int, grid: Grid, W: Floats, threshold: float,
        distance: Singles | None = None, per_sample: float = 0.0,
    ) -> tuple[Bytes, int, int]:  # fmt: skip
        whitening = fold(self.colours, W)
        ids = np.empty((grid.height, grid.width), np.uint8)
        if distance is None:
            # contiguous and writable, as true distances are: else the kernel is compiled twice
            distance = np.zeros((len(whitening.upper), *ids.shape), np.float32)
        coloured, foreground = classify(
            pixels, mask, shift, whitening.upper, whitening.offset, distance, per_sample, threshold,
            grid.x0, grid.y0, grid.stride, ids,
        )  # fmt: skip
        return ids, coloured, foreground

    def _remember_body(self, grid: Grid, drawing: PatchRenderer) -> None:
        shift = self.params.background.shift
        body = np.zeros(mask_size(self.camera.size_px[::-1], shift), np.uint8)
        rows, columns = np.nonzero(drawing.triangle_at >= 0)
        body[
            (grid.y0 + rows * grid.stride) >> shift, (grid.x0 + columns * grid.stride) >> shift
        ] = 255
        self._body = body


def mean_colours(pixels: Bytes, ids: Bytes) -> tuple[Floats, Ints]:
    """Mean RGB (10,3) in 0..1 of the pixels (h,w,3) BGR of each id 1..10, 0 without any, and their counts (10,)."""
    of = ids[ids > 0] - 1
    counts = np.bincount(of, minlength=10)
    sums = [np.bincount(of, channel, 10) for channel in pixels[ids > 0].T[::-1]]
    return np.stack(sums, axis=1) / (255.0 * np.maximum(counts, 1))[:, None], counts
