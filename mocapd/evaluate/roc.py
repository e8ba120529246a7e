"""How well colours are told apart, with and without the pose as prior (paper Fig. 6).

Both classifiers see the same pixels through the same Gaussians and the same white balance: that of
step 5 of the frame before. What differs is the prior C d, taken from the pose that was tracked.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.body.model import build_model
from mocapd.body.shirt import standard_shirt
from mocapd.capture.folder import frame_sets
from mocapd.clock import seconds
from mocapd.errors import InputError
from mocapd.evaluate.capture_eval import CaptureResult
from mocapd.evaluate.retraced import states
from mocapd.evaluate.truth import labelled_frames, read_label
from mocapd.tracker_setup import inputs_of_capture
from mocapd.trackers.colour.build import colour_model, white_balance_of
from mocapd.trackers.colour.fitting import Fitter, MotionState, Roi
from mocapd.trackers.colour.params import Params
from mocapd.types import Bytes, Floats, Frame, FrameSet
from mocapd.vision.classify_kernels import classify, classify_with_prior, sum_colours
from mocapd.vision.colour_model import ColourModel
from mocapd.vision.distance_maps import DistanceMaps
from mocapd.vision.white_balance import solve_white_balance
from mocapd.vision.whitening import fold

ALONE_THRESHOLDS = np.geomspace(0.4, 16.0, 28)  # [standard deviations]; the paper's T is 3
PRIOR_THRESHOLDS = np.geomspace(0.5, 20.0, 28)  # the paper's T is 5
MIXED = 255  # label of a work pixel that shows more than one thing
_NO_MASK, _NO_MASK_SHIFT = np.ones((1, 1), np.uint8), 31
_PRIOR_WEIGHT = 6.0  # C = 6 / s
_FULL_SHARE = 0.6  # an appearance of the shirt smaller than this share of a patch is not learned


@dataclass(frozen=True, slots=True, eq=False)
class Counts:
    """Work pixels at N thresholds: `right` of those on the shirt got their own colour, `wrong` of all
    got one that they have not. shirt and looked_at: how many there are."""

    right: Floats
    wrong: Floats
    shirt: float
    looked_at: float

    @property
    def correct(self) -> Floats:
        """Share (N,) of the shirt that is classified correctly."""
        return self.right / max(self.shirt, 1.0)

    @property
    def false(self) -> Floats:
        """Share (N,) of what was looked at that is classified as a colour it has not."""
        return self.wrong / max(self.looked_at, 1.0)

    def __add__(self, other: "Counts") -> "Counts":
        return Counts(
            self.right + other.right,
            self.wrong + other.wrong,
            self.shirt + other.shirt,
            self.looked_at + other.looked_at,
        )


@dataclass(frozen=True, slots=True, eq=False)
class Roc:
    """Counts over the thresholds of step 1 and of step 3; `tracker`: as the tracker itself classified."""

    alone: Counts
    assisted: Counts
    tracker: Counts

    def __add__(self, other: "Roc") -> "Roc":
        return Roc(
            self.alone + other.alone,
            self.assisted + other.assisted,
            self.tracker + other.tracker,
        )


def no_counts() -> Roc:
    """Nothing counted yet."""
    alone, prior = np.zeros(len(ALONE_THRESHOLDS)), np.zeros(len(PRIOR_THRESHOLDS))
    one = np.zeros(1)
    return Roc(
        Counts(alone, alone, 0.0, 0.0), Counts(prior, prior, 0.0, 0.0), Counts(one, one, 0.0, 0.0)
    )


def count(ids: Bytes, truth: Bytes) -> tuple[int, int]:
    """Right and wrong ones among ids (h,w), by truth (h,w): 0 not shirt, 1..10, MIXED not counted."""
    given = (ids > 0) & (truth != MIXED)
    right = given & (ids == truth)
    return int(right.sum()), int(given.sum() - right.sum())


def colour_truth(label: Bytes, roi_px: Roi, factor: int) -> Bytes:
    """Colours (h,w) of blocks of factor x factor pixels from patch labels; MIXED where they differ.

    roi_px: a region in pixels, whole blocks of which are used.
    """
    x0, y0, x1, y1 = roi_px
    h, w = (y1 - y0) // factor, (x1 - x0) // factor
    colours = standard_shirt().colour_of_patch[label[y0 : y0 + h * factor, x0 : x0 + w * factor]]
    blocks = colours.reshape(h, factor, w, factor)
    lowest, highest = blocks.min(axis=(1, 3)), blocks.max(axis=(1, 3))
    truth: Bytes = np.where(lowest == highest, lowest, MIXED).astype(np.uint8)
    return truth


@dataclass(slots=True)
class _Eye:
    """One camera: its work picture and its white balance, which step 5 follows."""

    index: int
    factor: int
    colours: ColourModel
    W: Floats

    def picture(self, frame: Frame) -> Bytes:
        """The frame averaged over blocks, as the tracker sees it."""
        h, w = (n // self.factor for n in frame.pixels.shape[:2])
        crop = frame.pixels[: h * self.factor, : w * self.factor]
        return np.asarray(cv2.resize(crop, (w, h), interpolation=cv2.INTER_AREA), dtype=np.uint8)

    def learn(self, picture: Bytes, rendered: Bytes, roi: Roi) -> None:
        """W for the next frame from the patches' inner pixels (step 5)."""
        inner = np.where(
            cv2.erode(rendered, np.ones((3, 3), np.uint8)) == rendered, rendered, 0
        ).astype(np.uint8)
        inner[cv2.dilate(rendered, np.ones((3, 3), np.uint8)) != rendered] = 0
        sums, counts = np.empty((10, 3), np.int64), np.empty(10, np.int64)
        sum_colours(picture, inner, roi[0], roi[1], 1, sums, counts)
        if counts.sum() > 0:
            means = sums / (255.0 * np.maximum(counts, 1))[:, None]
            self.W = solve_white_balance(
                means, self.colours.mean, counts.astype(float), prior=self.W
            )


def classification_roc(result: CaptureResult, stature_m: float) -> Roc:
    """Classify the labelled frames of a capture in the region around the tracked body.

    `stature_m` is for captures that do not say. Raises InputError when no frame is labelled.
    """
    folder = result.case.folder
    labelled = {camera.name: labelled_frames(folder.path, camera.name) for camera in folder.cameras}
    if not any(labelled.values()):
        raise InputError("no labelled frame", str(folder.path / "labels"), "choose other captures")
    inputs = inputs_of_capture(folder, stature_m)
    params = Params()
    colours = colour_model(inputs.model)
    factors = [max(1, round(c.size_px[0] / params.work_width_px)) for c in folder.rig.cameras]
    fitter = Fitter(build_model(inputs.stature_m), folder.rig.cameras, factors, params)
    eyes = {}
    for i, camera in enumerate(folder.rig.cameras):
        strokes = inputs.white_balance.get(camera.name)
        W = np.eye(3) if strokes is None else white_balance_of(strokes, colours, plain=True)
        eyes[camera.name] = _Eye(i, factors[i], colours, W)
    total = no_counts()
    for frames, state in _tracked(result, states(fitter, result.track)):
        for name, frame in frames.frames.items():
            eye, dt_s = eyes[name], seconds(frame.t_ns - frames.t_ns)
            roi = fitter.region(eye.index, state, dt_s, params.margin_px)
            if roi is None:
                continue
            picture, rendered = eye.picture(frame), fitter.render(eye.index, state, dt_s, roi)
            if frame.seq in labelled[name] and rendered.any():
                label = read_label(folder.path, name, frame.seq)
                total += _counts(eye, picture, rendered, roi, label, result, (name, frame.seq))
            eye.learn(picture, rendered, roi)
    return total
