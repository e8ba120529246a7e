"""One camera's segmentation: work pictures, colour ids in the present light, adaptation to light and background."""

from dataclasses import dataclass, field

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import plain
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.idmap_renderer import IdMapRenderer, Roi
from mocapd.fit.work_size import work_size
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.colour.colour_tables import colour_table
from mocapd.shirt.colour.lut_kernels import classify_by_table
from mocapd.shirt.colour.white_balance import remember_illumination
from mocapd.shirt.segmentation import bare_skin
from mocapd.shirt.segmentation import shirt_appearance as looks
from mocapd.shirt.segmentation.cell_kernels import (
    CELL,
    ClassifierWeights,
    LearnedPixels,
    classify,
    colour_distances,
)
from mocapd.shirt.segmentation.segmentation_kernels import (
    agreement,
    bare_pixels,
    colour_statistics,
    count_colours,
    find_shirt,
    suppress_background,
)
from mocapd.shirt.segmentation.segmentation_params import SegmentationParams
from mocapd.shirt.segmentation.shirt_appearance import ShirtAppearance
from mocapd.types import Bytes, Camera, Floats, Ints, Singles
from mocapd.vision.room_background import BackgroundParams, RoomBackground

Ids = NDArray[np.uint8]
_WHOLE = np.ones((1, 1), np.uint8)  # "no mask" of the table kernel
_ALL_CERTAIN = np.ones(10, np.int64)
_GAINS = (1.0, 1.8, 0.55)  # brightness to try with each reference illumination without a pose
_FARTHEST = 7  # cells from its predicted place at which a colour is looked for
_OLD_LIGHT = np.float32(0.25)  # share of the counts that stays after a change of light
_SKIN_EVERY = 3  # ticks
_WHITE_BALANCE_EVERY = 4  # ticks; between them the learned means alone follow the light
_FORGET_EVERY = 8  # ticks
_NEAR = cv2.getStructuringElement(cv2.MORPH_RECT, (25, 25))


@dataclass(slots=True)
class Memory:
    """Adaptive state of one camera since the last reset."""

    appearance: ShirtAppearance
    references: tuple[Floats, ...]  # reference illuminations, paper section 5.2
    body: Ids  # where the body was last, widened: not background
    shirt_count: NDArray[np.float32]
    other_count: NDArray[np.float32]
    skin: Floats = field(default_factory=lambda: np.zeros(4))  # see `bare_skin.statistics`
    skin_affine: Singles = field(default_factory=lambda: bare_skin.NOWHERE)
    usual: float = 0.0  # share of the rendered shirt that is usually classified
    usual_ticks: int = 0  # when that was updated
    ticks: int = 0  # of 1/30 s, that passed
    lights: int = 0  # see `RoomBackground`


@dataclass(frozen=True, slots=True, eq=False)
class ShirtCandidate:
    """A place where a shirt may be: the region, its ids (h,w), and the light they were read in."""

    roi: Roi
    ids: Ids
    W: Floats
    evenness: float


@dataclass(slots=True)
class CameraSegmenter:
    """One camera. Buffers are its own; `memory` is all that it remembers."""

    camera: Camera
    image_scale: int  # frames are averaged down by
    model: ColourModel
    W: Floats  # of the strokes
    params: SegmentationParams
    shared: RoomBackground | None = None  # another owner updates it; None: its own
    background: RoomBackground = field(init=False)
    memory: Memory = field(init=False)
    picture: Bytes = field(init=False)
    _ids: Ids = field(init=False)
    _pixel_weight: Ids = field(init=False)
    _distance: Ids = field(init=False)

    def __post_init__(self) -> None:
        w, h = self.size
        self._ids, self._pixel_weight = np.empty(h * w, np.uint8), np.empty(h * w, np.uint8)
        self._distance = np.empty((h // CELL + 1) * (w // CELL + 1) * 10, np.uint8)
        self.background = self.shared or RoomBackground(h, w, BackgroundParams())
        self.reset()

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the work picture."""
        return work_size(self.camera, self.image_scale)

    @property
    def _owns_background(self) -> bool:
        return self.shared is None

    def reset(self) -> None:
        """Forget everything but the strokes."""
        w, h = self.size
        if self._owns_background:
            self.background.reset()
        self.memory = Memory(
            appearance=looks.fresh(self.W),
            references=(self.W,),
            body=np.zeros((h, w), np.uint8),
            shirt_count=np.zeros(1 << 15, np.float32),
            other_count=np.zeros(1 << 15, np.float32),
        )
        self.picture = np.zeros((h, w, 3), np.uint8)

    def look(self, pixels: Bytes) -> None:
        """Take a frame (height,width,3): the work picture is its average over blocks."""
        w, h = self.size
        crop = pixels[: h * self.image_scale, : w * self.image_scale]
        self.take(np.asarray(cv2.resize(crop, (w, h), interpolation=cv2.INTER_AREA), np.uint8))

    def take(self, picture: Bytes, ticks: int = 1) -> None:
        """Take a work picture (h,w,3), so many ticks after the last."""
        self.picture = picture
        self.memory.ticks += ticks
        if self.background.lights != self.memory.lights:
            # colour counts of the old light are invalid
            self.memory.lights = self.background.lights
            self.memory.shirt_count *= _OLD_LIGHT
            self.memory.other_count *= _OLD_LIGHT

    # --- with a pose ---

    def classify(
        self, predicted: Ids, drawing: IdMapRenderer, roi: Roi, uncertain: Ints, may_relight: bool
    ) -> tuple[Ids, Ids]:
        """ids and pixel_weight (h,w) over the region, given the predicted id map and what drew it
        (buffers of this segmenter).

        uncertain: colours (0..9) of uncertain place. When the classification is poor, or much
        worse than usual, the best of several lights is taken: the one that maps the reference
        colours to the pixels at their expected places, and each reference illumination.
        """
        p, memory = self.params, self.memory
        rendered = int(np.count_nonzero(predicted))
        prior = p.prior_weight / (1.6 * np.sqrt(rendered) + 1.0)
        divisor = _ALL_CERTAIN.copy()
        divisor[uncertain] = 3
        distance = self._distances(
            predicted, drawing, int(min(p.threshold / (CELL * prior), _FARTHEST)), divisor
        )
        ids, pixel_weight = self._classify_in_light(memory.appearance, roi, distance, prior)
        if rendered == 0:
            return ids, pixel_weight
        inside = agreement(predicted, ids)[1] / rendered
        usual = memory.usual if memory.usual > 0 else inside
        passed, memory.usual_ticks = memory.ticks - memory.usual_ticks, memory.ticks
        keep = float(np.exp(-passed * TICK_S / p.usual_s))
        memory.usual = keep * usual + (1.0 - keep) * inside
        if may_relight and (inside < p.poor_classification or inside < p.sudden_loss * usual):
            best = self._relit(predicted, ids, roi, distance, prior)
            if best is not memory.appearance:
                memory.appearance = best
            ids, pixel_weight = self._classify_in_light(best, roi, distance, prior)
        return ids, pixel_weight

    def _relit(
        self, predicted: Ids, ids: Ids, roi: Roi, distance: Ids, prior: float
    ) -> ShirtAppearance:
        memory = self.memory
        observed = np.zeros((10, 4))
        colour_statistics(self.picture, roi[0], roi[1], predicted, ids, False, observed)
        best, most = memory.appearance, agreement(predicted, ids)[1]
        lights = [looks.adapt_to_light(memory.appearance, observed, self.model.mean)]
        if most < self.params.poor_classification * np.count_nonzero(predicted):
            lights += [looks.fresh(W) for W in memory.references]
        for light in lights:
            tried, _ = self._classify_in_light(light, roi, distance, prior)
            same = agreement(predicted, tried)[1]
            if same > 1.02 * most:
                best, most = light, same
        return best

    def _classify_in_light(
        self, appearance: ShirtAppearance, roi: Roi, distance: Ids, prior: float
    ) -> tuple[Ids, Ids]:
        p, memory = self.params, self.memory
        h, w = roi[3] - roi[1], roi[2] - roi[0]
        ids, pixel_weight = (
            self._ids[: h * w].reshape(h, w),
            self._pixel_weight[: h * w].reshape(h, w),
        )
        mean, covariance = looks.gaussians(
            appearance, self.model.mean, self.model.covariance, p.cloth_sd, p.noise_sd, p.shading_sd
        )
        learned = LearnedPixels(
            self.background.mean, self.background.age, memory.shirt_count, memory.other_count
        )
        weights = ClassifierWeights(
            float(prior), p.threshold, p.background_tolerance, p.background_penalty,
            p.other_penalty, p.skin_penalty, p.soft_unclassified, p.soft_unknown,
        )  # fmt: skip
        classify(
            self.picture, roi[0], roi[1], distance, looks.whitening(mean, covariance),
            memory.skin_affine,
            plain(learned), plain(weights), ids, pixel_weight,
        )  # fmt: skip
        return ids, pixel_weight

    def _distances(self, predicted: Ids, drawing: IdMapRenderer, limit: int, divisor: Ints) -> Ids:
        h, w = predicted.shape
        h4, w4 = -(-h // CELL), -(-w // CELL)
        out = self._distance[: h4 * w4 * 10].reshape(h4, w4, 10)
        colour_distances(
            predicted, drawing.xy, drawing.model.triangles, drawing.labels.arms, drawing.labels.label,
            limit, divisor, out,
        )  # fmt: skip
        return out

    def learn(
        self,
        final: Ids,
        ids: Ids,
        pixel_weight: Ids,
        roi: Roi,
        dt_s: float,
        sure: bool,
        face: bare_skin.Disc | None = None,
    ) -> None:
        """Follow the light from the id map of the final pose (paper section 5.2, step 5).

        dt_s: since the last update, at 30 Hz a tick. sure: the pose agrees well enough to separate the shirt from
        other objects. face: its disc, if visible.
        """
        p, memory = self.params, self.memory
        sums = np.zeros((10, 4))
        colour_statistics(self.picture, roi[0], roi[1], final, ids, True, sums)
        learned = looks.learn(memory.appearance, sums, dt_s, p.colour_memory_s)
        W = learned.W
        if self._is_due(_WHITE_BALANCE_EVERY, dt_s):
            W = looks.white_balance(learned, self.model.mean)
        memory.appearance = ShirtAppearance(W, learned.sums)
        if sure:
            memory.references = remember_illumination(memory.references, W)
            count_colours(
                self.picture, roi[0], roi[1], memory.body, final, ids, pixel_weight,
                memory.shirt_count, memory.other_count,
            )  # fmt: skip
        if sure and face is not None:
            pixels = bare_skin.statistics(self.picture, final, roi[:2], face, W)
            memory.skin = bare_skin.add_statistics(
                memory.skin, pixels, max(_SKIN_EVERY * TICK_S, dt_s), p.skin_memory_s
            )
            memory.skin_affine = bare_skin.whitening(
                memory.skin, p.cloth_sd, p.noise_sd, p.shading_sd
            )
        if self._is_due(_FORGET_EVERY, dt_s):
            keep = np.float32(np.exp(-max(_FORGET_EVERY * TICK_S, dt_s) / p.count_memory_s))
            memory.shirt_count *= keep
            memory.other_count *= keep

    def bare(self, roi: Roi, ids: Ids) -> NDArray[np.bool_] | None:
        """Where a bare hand may be (h,w), of a region that was classified as ids; None without a skin model."""
        p, memory = self.params, self.memory
        if memory.skin_affine is bare_skin.NOWHERE:
            return None
        out = np.empty(ids.shape, np.bool_)
        bare_pixels(
            self.picture, roi[0], roi[1], ids, memory.skin_affine, p.bare_threshold,
            self.background.mean, self.background.age, 255.0 * p.background_tolerance, out,
        )  # fmt: skip
        return bare_skin.hand_sized(out)

    def is_due_for_skin(self, dt_s: float) -> bool:
        """Whether a face is to be looked at in this frame; dt_s: see `learn`."""
        return self._is_due(_SKIN_EVERY, dt_s)

    def _is_due(self, every: int, dt_s: float) -> bool:
        """Whether a multiple of so many ticks passed within dt_s."""
        now = self.memory.ticks
        return now // every > (now - max(1, round(dt_s / TICK_S))) // every

    def mark_body(self, final: Ids | None, roi: Roi) -> None:
        """Mask the body out of the background model; None: no pose."""
        self.memory.body[:] = 0
        if final is not None:
            x0, y0, x1, y1 = roi
            solid = (final > 0).astype(np.uint8)
            self.memory.body[y0:y1, x0:x1] = cv2.dilate(solid, _NEAR)

    def learn_background(self, ticks: int) -> None:
        """Update the background outside the body, unless it has another owner; ticks: see `RoomBackground.learn`."""
        if self._owns_background:
            self.background.follow_light(self.picture, self.memory.body)
            self.background.learn(self.picture, self.memory.body, ticks)

    # --- without a pose ---

    def find(self, sizes: Ints) -> ShirtCandidate | None:
        """Best region of evenly mixed shirt colours, over all reference illuminations; None without one."""
        p, memory = self.params, self.memory
        model = self.model.tolerating(p.shading_sd, p.cloth_sd)
        w, h = self.size
        best: ShirtCandidate | None = None
        lights = [W * gain for gain in _GAINS for W in memory.references]
        for W in lights:
            table = colour_table(model, W, p.first_threshold)
            ids = np.empty((h, w), np.uint8)
            classify_by_table(self.picture, _WHOLE, 31, table, 0, 0, 1, ids)
            suppress_background(
                self.picture,
                self.background.mean,
                self.background.age,
                p.background_tolerance,
                ids,
            )
            x0, y0, x1, y1, evenness = find_shirt(ids, sizes)
            if evenness >= p.found_evenness and (best is None or evenness > best.evenness):
                grow = (x1 - x0) // 2
                roi = (
                    max(0, x0 - grow) & ~1, max(0, y0 - grow) & ~1,
                    min(w, x1 + grow), min(h, y1 + grow),
                )  # fmt: skip
                best = ShirtCandidate(
                    roi, ids[roi[1] : roi[3], roi[0] : roi[2]].copy(), W, evenness
                )
        return best

    def set_light(self, W: Floats) -> None:
        """Read the pictures in this light from now on."""
        self.memory.appearance = looks.fresh(W)
        self.memory.usual = 0.0
