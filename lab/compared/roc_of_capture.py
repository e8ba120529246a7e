"""The classifiers of step 1 and step 3 over a capture's labelled frames (paper Fig. 6).

Both see the same pixels through the same Gaussians and the same white balance, which step 5 made in
the frame before. What differs is the prior C d, taken from the pose that was tracked.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from lab.compared.patch_labels import labelled_frames, read_label
from lab.compared.retraced import states
from lab.compared.roc import (
    Roc,
    Roi,
    colour_truth,
    count,
    no_roc,
    sweep_alone,
    sweep_assisted,
)
from mocapd.body.model import build_model
from mocapd.calibration.calibration_record import ShirtColours
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import frame_sets
from mocapd.clock import nanoseconds, seconds
from mocapd.evaluate.capture_eval import CaptureResult, Evidence
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.work_size import image_scales
from mocapd.published.wang2011.distance_maps import distance_maps
from mocapd.published.wang2011.segmenter import mean_colours
from mocapd.shirt.colour.colour_model import ColourModel, fold
from mocapd.shirt.colour.from_pictures import colour_model, white_balance_of
from mocapd.shirt.colour.white_balance import solve_white_balance
from mocapd.shirt.garment import shirt_labels
from mocapd.tracking.cues.shirt.shirt_params import ShirtParams
from mocapd.types import Bytes, Camera, Floats, Frame, FrameSet

_PRIOR_WEIGHT = 6.0  # C = 6 / s, s being the side of the shirt's square
_WHOLE = np.ones((3, 3), np.uint8)


@dataclass(slots=True)
class _CaptureSegmenter:
    """One camera of the rig: its labelled frames, and its white balance, which step 5 follows."""

    index: int
    camera: Camera
    video: Path
    factor: int
    labelled: tuple[int, ...]
    colours: ColourModel
    W: Floats

    def picture(self, frame: Frame) -> Bytes:
        """The frame averaged over blocks, as the tracker sees it."""
        w, h = (n // self.factor for n in self.camera.size_px)
        crop = frame.pixels[: h * self.factor, : w * self.factor]
        return np.asarray(cv2.resize(crop, (w, h), interpolation=cv2.INTER_AREA), dtype=np.uint8)

    def learn(self, picture: Bytes, rendered: Bytes, roi: Roi) -> None:
        """W for the next frame from the inner pixels of the rendered patches (step 5)."""
        edge = cv2.dilate(rendered, _WHOLE) != cv2.erode(rendered, _WHOLE)
        inner = np.where(edge, 0, rendered).astype(np.uint8)
        means, counts = mean_colours(picture[roi[1] : roi[3], roi[0] : roi[2]], inner)
        if counts.sum() > 0:
            weights = counts.astype(float)
            self.W = solve_white_balance(means, self.colours.mean, weights, prior=self.W)


def roc_of_capture(result: CaptureResult, stature_m: float) -> Roc:
    """Classify the labelled frames of a capture in the region around the tracked body.

    `stature_m` is for captures that do not say.
    """
    folder = result.case.folder
    shirt = from_capture(folder).shirt or ShirtColours()
    params, colours = ShirtParams(), colour_model(shirt.model)
    factors = image_scales(folder.rig.cameras, params.fit.work_width_px)
    segmenters: dict[str, _CaptureSegmenter] = {}
    for i, (camera, recorded) in enumerate(zip(folder.rig.cameras, folder.cameras, strict=True)):
        strokes = shirt.white_balance.get(camera.name)
        W = np.eye(3) if strokes is None else white_balance_of(strokes, colours, plain=True)
        labelled = labelled_frames(folder.path, recorded.video)
        segmenters[camera.name] = _CaptureSegmenter(
            i, camera, recorded.video, factors[i], labelled, colours, W
        )
    body = build_model(folder.stature_m or stature_m)
    fitter = Fitter(body, shirt_labels(body), folder.rig.cameras, factors, params.fit)

    total = no_roc()
    for frames, state in _tracked(result, fitter):
        for name, frame in frames.frames.items():
            segmenter, dt_s = segmenters[name], seconds(frame.t_ns - frames.t_ns)
            roi = fitter.drawings[segmenter.index].region(
                state, dt_s, params.segmentation.margin_px
            )
            if roi is None:
                continue
            picture, rendered = (
                segmenter.picture(frame),
                fitter.drawings[segmenter.index].render(state, dt_s, roi),
            )
            if frame.seq in segmenter.labelled and rendered.any():
                label = read_label(folder.path, segmenter.video, frame.seq)
                total += _roc(segmenter, picture, rendered, roi, label)
                if (name, frame.seq) in result.evidence:
                    total += _as_it_ran(result.evidence[name, frame.seq], label)
            segmenter.learn(picture, rendered, roi)
    return total


def _tracked(result: CaptureResult, fitter: Fitter) -> Iterator[tuple[FrameSet, MotionState]]:
    """The frame sets in which somebody was tracked, and the state."""
    times_ns = [nanoseconds(time_s) for time_s in result.track.times_s]
    known = dict(zip(times_ns, states(fitter, result.track), strict=True))
    for frames in frame_sets(result.case.folder):
        if frames.t_ns in known:
            yield frames, known[frames.t_ns]


def _roc(
    segmenter: _CaptureSegmenter, picture: Bytes, rendered: Bytes, roi: Roi, label: Bytes
) -> Roc:
    x0, y0, x1, y1 = (n * segmenter.factor for n in roi)
    truth = colour_truth(label, (x0, y0, x1, y1), segmenter.factor)
    whitening = fold(segmenter.colours, segmenter.W)
    rows, columns = np.nonzero(rendered)
    side_px = 1 + max(np.ptp(rows), np.ptp(columns))
    distance_px, _ = distance_maps(rendered, float(sum(rendered.shape)))
    return Roc(
        sweep_alone(truth, picture, roi, whitening),
        sweep_assisted(truth, picture, roi, whitening, distance_px, _PRIOR_WEIGHT / side_px),
        no_roc().tracker,
    )


def _as_it_ran(evidence: Evidence, label: Bytes) -> Roc:
    x0, _, x1, _ = evidence.roi_px
    factor = max(1, round((x1 - x0) / evidence.ids.shape[1]))
    truth = colour_truth(label, evidence.roi_px, factor)
    h, w = truth.shape
    nothing = no_roc()
    return Roc(nothing.alone, nothing.assisted, count(truth, [evidence.ids[:h, :w]]))
