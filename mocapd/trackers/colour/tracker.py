"""The colour tracker's step machine: predict, classify, fit, judge, learn; or look for the shirt anew."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray

from mocapd.body.model import N_POSE, BodyModel, build_model
from mocapd.body.shape import skeleton_of
from mocapd.trackers.colour import appearance as looks
from mocapd.trackers.colour.appearance import Appearance
from mocapd.trackers.colour.fitting import Fit, Fitter, MotionState, Roi, View
from mocapd.trackers.colour.params import Params
from mocapd.trackers.colour.segmentation_kernels import (
    agreement,
    classify,
    colour_distances,
    colour_statistics,
    learn_background,
)
from mocapd.types import Bytes, Camera, Floats, FrameSet


@dataclass(slots=True)
class CameraMemory:
    """What the tracker has learned of one camera: the only mutable record, owned by the tracker."""

    appearance: Appearance
    references: list[Floats]  # reference illuminations, paper section 5.2
    background_mean: NDArray[np.float32]
    background_age: NDArray[np.uint8]
    body_mask: NDArray[np.uint8]
    shirt_count: NDArray[np.float32]
    other_count: NDArray[np.float32]
    phase: int = 0


class Segmenter:
    """Work pictures and colour ids of one camera; the buffers live here."""

    def __init__(self, camera: Camera, factor: int, model_mean: Floats, model_cov: Floats, params: Params):
        self.camera, self.factor, self.params = camera, factor, params
        self.model_mean, self.model_cov = model_mean, model_cov
        self.size = (camera.size_px[0] // factor, camera.size_px[1] // factor)
        w, h = self.size
        self._ids = np.empty(h * w, np.uint8)
        self._softness = np.empty(h * w, np.uint8)
        self._distance = np.empty(((h + 1) // 2 + 1) * ((w + 1) // 2 + 1) * 10, np.uint8)

    def memory(self, W: Floats) -> CameraMemory:
        w, h = self.size
        return CameraMemory(
            looks.fresh(W), [W], np.zeros((h, w, 3), np.float32), np.zeros((h, w), np.uint8),
            np.zeros((h, w), np.uint8), np.zeros(1 << 15, np.float32), np.zeros(1 << 15, np.float32),
        )  # fmt: skip

    def work_picture(self, pixels: Bytes) -> Bytes:
        """The frame averaged down by the camera's factor."""
        if self.factor == 1:
            return pixels
        w, h = self.size
        crop = pixels[: h * self.factor, : w * self.factor]
        return cv2.resize(crop, (w, h), interpolation=cv2.INTER_AREA)

    def affine(self, appearance: Appearance) -> Floats:
        p = self.params
        return looks.whitening(
            *looks.gaussians(appearance, self.model_mean, self.model_cov, p.colour_sd_floor, p.shading_sd)
        )

    def distances(self, predicted: NDArray[np.uint8], limit: int, divisor: NDArray[np.int64]) -> NDArray[np.uint8]:
        h, w = predicted.shape
        h2, w2 = (h + 1) // 2, (w + 1) // 2
        out = self._distance[: h2 * w2 * 10].reshape(h2, w2, 10)
        colour_distances(predicted, limit, divisor, out)
        return out

    def classify(
        self, picture: Bytes, roi: Roi, distance: NDArray[np.uint8], prior: float, affine: Floats, memory: CameraMemory
    ) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
        """ids and softness (h,w) over the region; the arrays are this object's buffers."""
        p = self.params
        h, w = roi[3] - roi[1], roi[2] - roi[0]
        ids, softness = self._ids[: h * w].reshape(h, w), self._softness[: h * w].reshape(h, w)
        classify(
            picture, roi[0], roi[1], distance, affine, prior, p.threshold,
            memory.background_mean, memory.background_age, p.background_tolerance, p.background_penalty,
            memory.shirt_count, memory.other_count, p.other_penalty,
            p.soft_unclassified, p.soft_unknown, ids, softness,
        )  # fmt: skip
        return ids, softness
