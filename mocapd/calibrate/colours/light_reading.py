"""Reads a frozen picture without a known light: estimates the light and the wearer's pose.

A histogram search on colour ids finds shirt candidates under every light hypothesis. The reader refines the
best ones: the pose database gives the pose, the fitter aligns the body, and the patches of the fitted body give
the white balance, repeated until convergence. The reading with the best agreement of body and picture wins.
With a calibrated rig the cameras are then fitted together, each in its own light.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.calibrate.colours.light_hypotheses import light_hypotheses
from mocapd.calibrate.colours.light_refinement import IDLE_TURNS, LightRefinement, Reading
from mocapd.errors import InputError
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.view import View
from mocapd.geometry.rotations import IDENTITY_XYZW
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.garment import confirmed_colours
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.shirt.segmentation.camera_segmenter import CameraSegmenter, ShirtCandidate
from mocapd.shirt.segmentation.shirt_appearance import fresh
from mocapd.tracking.cues.shirt import shirt_search as detection
from mocapd.tracking.cues.shirt.shirt_params import ShirtParams
from mocapd.types import Bytes, Camera

MEAN_STATURE_M = 1.72  # one camera cannot distinguish size from distance
_FOLLOWED = 16  # candidates to refine
_FINALISTS = 4  # candidates to refine until convergence
_ALIKE = 0.15  # |W - W'|_F under which two candidates at one place are equal
_ALIKE_PX = 24  # work px
_FIRST_TURNS = 2
_LAST_TURNS = 8  # of the arm search, so that all of its library is tried
_ALONE = 0.8  # share of the work that each camera's own reading is
_ARM_JOINTS = [
    INDEX[side + bone]
    for side in ("left", "right")
    for bone in ("Shoulder", "UpperArm", "LowerArm")
]
_GAINS = (1.0, 1.8)  # brightness beyond that of the hypotheses


# runs the readings of several cameras: `map`, or that of a pool of threads
MapCameras = Callable[
    [Callable[[int], "Reading | InputError"], Iterable[int]], Iterable["Reading | InputError"]
]


class LightReader:
    """Reads frozen pictures of the cameras of one session; has buffers, but no state between calls."""

    def __init__(
        self,
        cameras: Sequence[Camera],
        model: ColourModel,
        database: PoseDatabase,
        stature_m: float,
    ) -> None:
        self._params = ShirtParams()
        self._cameras, self._database = tuple(cameras), database
        self._refinement = LightRefinement(self._cameras, model, stature_m, self._params)
        self._segmenters = self._refinement.segmenters
        self.drawings = self._refinement.fitter.drawings
        """By camera the renderer of a reading's body."""

    def read(self, index: int, pixels: Bytes, progress: Callable[[float], None]) -> Reading:
        """Camera `index`'s picture (H,W,3) BGR in the light with the best agreement. Raises InputError.

        Several threads may read different cameras at once. progress: of this camera, 0..1.
        """
        segmenter, camera = self._segmenters[index], self._cameras[index]
        _check_size(pixels, camera)
        segmenter.reset()
        segmenter.look(pixels)
        readings = []
        for i, candidate in enumerate(self._candidates(segmenter)):
            progress(i / (_FOLLOWED + _FINALISTS))
            fit = self._fit_from_database(index, candidate)
            if fit is None:
                continue
            start = fresh(candidate.W)
            reading = self._refinement.follow(index, fit, start, range(_FIRST_TURNS))
            if reading is not None and reading.colours >= self._params.accept_colours:
                readings.append(reading)
        if not readings:
            raise InputError(
                "no shirt was found under any light",
                camera.name,
                "stand where the whole upper body is in the picture, with more light on the shirt, "
                "or draw the strokes by hand",
            )
        readings.sort(key=lambda r: -r.score)
        turns = range(_FIRST_TURNS, _FIRST_TURNS + _LAST_TURNS)
        finals = []
        for i, r in enumerate(readings[:_FINALISTS]):
            progress((_FOLLOWED + i) / (_FOLLOWED + _FINALISTS))
            finals.append(self._refinement.follow(index, r.fit, r.appearance, turns) or r)
        return max([*finals, readings[0]], key=lambda r: r.score)

    def read_together(
        self,
        pictures: Mapping[int, Bytes],
        progress: Callable[[float], None],
        map_cameras: MapCameras,
    ) -> dict[int, Reading]:
        """Simultaneous pictures by camera index, of cameras with known extrinsics. Raises InputError
        when no camera shows a shirt; the result lacks cameras without one.

        A camera keeps its own reading where that agrees better than the common body. progress: 0..1.
        """
        shares = dict.fromkeys(pictures, 0.0)

        def read(index: int) -> Reading | InputError:
            def report(share: float) -> None:
                shares[index] = share
                progress(_ALONE * sum(shares.values()) / len(shares))

            try:
                return self.read(index, pictures[index], report)
            except InputError as error:
                return error

        own: dict[int, Reading] = {}
        troubles = []
        for index, result in zip(pictures, map_cameras(read, pictures), strict=True):
            if isinstance(result, Reading):
                own[index] = result
            else:
                troubles.append(result)
        if troubles and not own:
            raise troubles[0]
        progress(_ALONE)
        return self._common(own) if len(own) > 1 else own

    # --- stages ---

    def _candidates(self, segmenter: CameraSegmenter) -> list[ShirtCandidate]:
        """The most even candidates over all lights, without duplicates, best first."""
        candidates: list[ShirtCandidate] = []
        for W in light_hypotheses(segmenter.picture):
            segmenter.memory.references = (W,)
            candidate = segmenter.find(detection.WINDOWS)
            if candidate is not None:
                candidates.append(candidate)
        candidates.sort(key=lambda candidate: -candidate.evenness)
        distinct: list[ShirtCandidate] = []
        for candidate in candidates:
            if len(distinct) < _FOLLOWED and not any(
                _alike(candidate, other) for other in distinct
            ):
                distinct.append(candidate)
        return distinct

    def _fit_from_database(self, index: int, candidate: ShirtCandidate) -> Fit | None:
        """The pose from the database, fitted to the ids of the search."""
        p, segmenter = self._params, self._segmenters[index]
        segmenter.memory.references = (candidate.W,)
        sighting = detection.detect_shirt(index, segmenter, self._database, p.neighbours)
        if sighting is None:
            return None
        model = self._refinement.fitter.model
        states = detection.hypotheses(
            [sighting],
            self._cameras,
            self._database,
            np.ones(model.n_shape),
            initial_information(model.space),
            model.n_pose,
        )
        candidate = sighting.candidate
        unknown = np.full(candidate.ids.shape, int(255 * p.segmentation.soft_unknown), np.uint8)
        view = View(index, candidate.roi, candidate.ids, unknown, 0.0)
        asked = [_arms_out(state) for state in states]
        return detection.best_fit(self._refinement.fitter, states + asked, [view])

    def _common(self, own: Mapping[int, Reading]) -> dict[int, Reading]:
        """One body fitted to all cameras, started from each camera's own reading."""
        best: list[Reading] = []
        lights = {
            i: tuple(
                W * gain for W in light_hypotheses(self._segmenters[i].picture) for gain in _GAINS
            )
            for i in own
        }
        for start in own.values():
            for index, reading in own.items():
                memory = self._segmenters[index].memory
                memory.appearance = reading.appearance
                # a camera with a wrong light tries all of them on the other camera's body
                memory.references = lights[index]
            fit = start.fit
            most, idle = 0.0, 0
            for turn in range(_FIRST_TURNS + _LAST_TURNS):
                views = [v for i in own if (v := self._refinement.classify(i, fit)) is not None]
                if len(views) < len(own) or idle == IDLE_TURNS:
                    break
                for index in own:
                    self._segmenters[index].memory.references = ()
                fit = self._refinement.fit(fit.state, views, turn)
                agreement = (fit.explained, confirmed_colours(fit))
                readings = [
                    Reading(fit, v, self._segmenters[v.index].memory.appearance, *agreement)
                    for v in views
                ]
                idle = 0 if readings[0].score > most else idle + 1
                most = max(most, readings[0].score)
                if not best or most > best[0].score:
                    best = readings
                for view in views:
                    self._refinement.update_light(view.index, fit.state, view)
        out = dict(own)
        for reading in best:
            alone = own[reading.view.index]
            mine = self._refinement.judged_alone(reading)
            if mine.score >= self._refinement.judged_alone(alone).score:
                out[reading.view.index] = mine
        return out


def _arms_out(state: MotionState) -> MotionState:
    """The same with both arms held out, as the instructions ask."""
    local = state.local_xyzw.copy()
    local[_ARM_JOINTS] = IDENTITY_XYZW
    return replace(state, local_xyzw=local)


def _alike(a: ShirtCandidate, b: ShirtCandidate) -> bool:
    near = max(abs(p - q) for p, q in zip(a.roi, b.roi, strict=True)) <= _ALIKE_PX
    return near and float(np.linalg.norm(a.W - b.W)) < _ALIKE


def _check_size(pixels: Bytes, camera: Camera) -> None:
    w, h = camera.size_px
    if pixels.shape[:2] != (h, w):
        raise InputError(
            f"the picture is {pixels.shape[1]}x{pixels.shape[0]}, the lens is known for {w}x{h}",
            camera.name,
            "freeze a frame in the mode that the lens was calibrated in",
        )
