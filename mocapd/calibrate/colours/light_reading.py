"""A frozen picture read without any knowledge of the light: which light, and how the wearer stands in it.

Every light hypothesis is asked where it sees a shirt (histogram search on colour ids); the most
promising are followed: the pose database names the pose, the body is fitted, the white balance is
solved from the patches as the fitted body shows them, and again until it settles. The reading under
which body and picture agree best wins. With a known rig the cameras are then fitted together, each
in its own light.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from mocapd.body.skeleton import INDEX
from mocapd.calibrate.colours.light_hypotheses import light_hypotheses
from mocapd.calibrate.colours.light_refinement import IDLE_TURNS, LightRefinement, Reading
from mocapd.errors import InputError
from mocapd.fit.body_drawing import IdMapRenderer
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

MEAN_STATURE_M = 1.72  # a picture from one camera does not tell size from distance
_FOLLOWED = 16  # candidates that are followed
_FINALISTS = 4  # of which so many are followed to the end
_ALIKE = 0.15  # |W - W'|_F under which two candidates about one place are one
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


def _quiet(_: float) -> None:
    """Nobody watches."""


class LightReader:
    """Reads frozen pictures of the cameras of one session; keeps buffers, remembers nothing."""

    def __init__(
        self,
        cameras: Sequence[Camera],
        model: ColourModel,
        database: PoseDatabase,
        stature_m: float = MEAN_STATURE_M,
        params: ShirtParams | None = None,
    ) -> None:
        self._params = params if params is not None else ShirtParams()
        self._cameras, self._database = tuple(cameras), database
        self._refinement = LightRefinement(self._cameras, model, stature_m, self._params)
        self._segmenters = self._refinement.segmenters

    def drawing(self, index: int) -> IdMapRenderer:
        """What draws a reading's body into camera `index`."""
        return self._refinement.drawing(index)

    def read(
        self, index: int, pixels: Bytes, progress: Callable[[float], None] = _quiet
    ) -> Reading:
        """Camera `index`'s picture (H,W,3) BGR in the light that explains it best. Raises InputError.

        Different cameras may be read by different threads at once. progress: of this camera, 0..1.
        """
        segmenter, camera = self._segmenters[index], self._cameras[index]
        _check_size(pixels, camera)
        segmenter.reset()
        segmenter.look(pixels)
        readings = []
        for i, (name, found) in enumerate(self._candidates(segmenter)):
            progress(i / (_FOLLOWED + _FINALISTS))
            fit = self._detected(index, found)
            if fit is None:
                continue
            start = fresh(found.W)
            reading = self._refinement.follow(index, name, fit, start, range(_FIRST_TURNS))
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
            finals.append(self._refinement.follow(index, r.light, r.fit, r.appearance, turns) or r)
        return max([*finals, readings[0]], key=lambda r: r.score)

    def read_together(
        self,
        pictures: Mapping[int, Bytes],
        progress: Callable[[float], None] = _quiet,
        map_cameras: MapCameras = map,
    ) -> dict[int, Reading]:
        """Pictures of one moment by camera index, in cameras whose places are known. Raises InputError
        when no camera shows a shirt; a camera that shows none is left out.

        A camera keeps its own reading where it agrees better than the common body. progress: 0..1.
        """
        shares = dict.fromkeys(pictures, 0.0)

        def read(index: int) -> Reading | InputError:
            def told(share: float) -> None:
                shares[index] = share
                progress(_ALONE * sum(shares.values()) / len(shares))

            try:
                return self.read(index, pictures[index], told)
            except InputError as error:
                return error

        own: dict[int, Reading] = {}
        troubles = []
        for index, one in zip(pictures, map_cameras(read, pictures), strict=True):
            if isinstance(one, Reading):
                own[index] = one
            else:
                troubles.append(one)
        if troubles and not own:
            raise troubles[0]
        progress(_ALONE)
        return self._common(own) if len(own) > 1 else own

    # --- stages ---

    def _candidates(self, segmenter: CameraSegmenter) -> list[tuple[str, ShirtCandidate]]:
        """The most even places over all lights, no two alike, best first."""
        found: list[tuple[str, ShirtCandidate]] = []
        for light in light_hypotheses(segmenter.picture):
            segmenter.memory.references = (light.W,)
            seen = segmenter.find(detection.WINDOWS)
            if seen is not None:
                found.append((light.name, seen))
        found.sort(key=lambda f: -f[1].evenness)
        kept: list[tuple[str, ShirtCandidate]] = []
        for name, seen in found:
            if len(kept) < _FOLLOWED and not any(_alike(seen, other) for _, other in kept):
                kept.append((name, seen))
        return kept

    def _detected(self, index: int, found: ShirtCandidate) -> Fit | None:
        """The body as the pose database has it, fitted to the ids of the search."""
        p, segmenter = self._params, self._segmenters[index]
        segmenter.memory.references = (found.W,)
        sighting = detection.sight(index, segmenter, self._database, p.neighbours)
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
        seen = sighting.found
        unknown = np.full(seen.ids.shape, int(255 * p.segmentation.soft_unknown), np.uint8)
        view = View(index, seen.roi, seen.ids, unknown, 0.0)
        asked = [_arms_out(state) for state in states]
        return detection.best_fit(self._refinement.fitter, states + asked, [view])

    def _common(self, own: Mapping[int, Reading]) -> dict[int, Reading]:
        """One body fitted to all cameras, started from what each saw alone."""
        best: list[Reading] = []
        lights = {
            i: tuple(
                light.W * gain
                for light in light_hypotheses(self._segmenters[i].picture)
                for gain in _GAINS
            )
            for i in own
        }
        for start in own.values():
            for index, reading in own.items():
                memory = self._segmenters[index].memory
                memory.appearance = reading.appearance
                # a camera that misread its light tries them all on the other's body
                memory.references = lights[index]
            fit, light = start.fit, start.light
            most, idle = 0.0, 0
            for turn in range(_FIRST_TURNS + _LAST_TURNS):
                views = [v for i in own if (v := self._refinement.classify(i, fit)) is not None]
                if len(views) < len(own) or idle == IDLE_TURNS:
                    break
                for index in own:
                    self._segmenters[index].memory.references = ()
                fit = self._refinement.fit(fit.state, views, turn)
                seen = (fit.explained, confirmed_colours(fit))
                readings = [
                    Reading(light, fit, v, self._segmenters[v.index].memory.appearance, *seen)
                    for v in views
                ]
                idle = 0 if readings[0].score > most else idle + 1
                most = max(most, readings[0].score)
                if not best or most > best[0].score:
                    best = readings
                for view in views:
                    self._refinement.relight(view.index, fit.state, view)
        out = dict(own)
        for reading in best:
            alone = own[reading.view.index]
            mine = self._refinement.judged_alone(reading)
            if mine.score >= self._refinement.judged_alone(alone).score:
                out[reading.view.index] = replace(mine, light=alone.light)
        return out


def _arms_out(state: MotionState) -> MotionState:
    """The same with both arms held out, as the user is asked to stand."""
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
