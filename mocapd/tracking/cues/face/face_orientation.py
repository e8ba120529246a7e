"""Front-back test by face detection: from front and back two cameras side by side see the same outline.

A frontal face where the tracked head should face away is evidence for a flipped body. A missing face is weak evidence:
the head may look down, be covered, or defeat the cascade.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.body.head_proportions import FACE_WIDTH, MIDDLE
from mocapd.body.skeleton import INDEX
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre, project, to_camera
from mocapd.tracking.ticks import Ticks
from mocapd.types import Camera, Floats, FrameSet
from mocapd.vision.face.face_detection import faces_near
from mocapd.vision.face.lbp_cascade_kernels import CascadeArrays

_REACH = 0.6  # about the head's place, of the face's side
_FORWARD = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True)
class FaceOrientationParams:
    """When a face is looked for, and what it tells."""

    every_s: float = 2 / 30  # from one look to the next; each at another camera
    away_rad: float = (
        2.4  # from a camera, that a chest faces: an ear at 2.1 is sometimes detected as a face
    )
    windows: int = 2  # that agree on a face
    rate: float = 0.5  # of looks at frontal faces that find them
    false_rate: float = 0.02  # of looks at other things that find one
    sure: float = (
        7.0  # logarithm of the odds at which the body is turned round: three faces in a row
    )


class FaceOrientation:
    """Log-odds that the tracked body is flipped; no other state."""

    def __init__(
        self, cascade: CascadeArrays, stature_m: float, params: FaceOrientationParams
    ) -> None:
        """cascade: of frontal faces, see `vision.face.lbp_cascade`."""
        self._cascade, self._stature_m, self._params = cascade, stature_m, params
        self.reset()

    def reset(self) -> None:
        """Clears the evidence."""
        self._odds = 0.0

    @property
    def is_reversed(self) -> bool:
        """True if the body very likely faces the other way."""
        return self._odds > self._params.sure

    def rehearse(self) -> None:
        """Look once at nothing: the first face must not wait for its kernels to be compiled or loaded."""
        blank = np.zeros((64, 64), np.uint8)
        faces_near(self._cascade, blank, 32.0, 32.0, 28.0, 8.0, self._params.windows)

    def update(
        self,
        fitter: Fitter,
        state: MotionState,
        views: Sequence[View],
        frames: FrameSet,
        ticks: Ticks,
    ) -> None:
        """Look for the face of a body in one of the views, if that is due; ticks: that passed with the frame set."""
        p = self._params
        if not views or not ticks.due(p.every_s):
            return
        looks = int(ticks.last * TICK_S / p.every_s + 1e-6)
        camera = fitter.drawings[views[looks % len(views)].index].camera
        joints, globals_ = fitter.joints(state)
        head, chest = INDEX["head"], INDEX["upperChest"]
        middle = joints[head] + rotations.rotate(globals_[head], MIDDLE * self._stature_m)
        if _away_rad(globals_[chest], camera, middle) < p.away_rad:
            return
        share = (
            (p.rate, p.false_rate)
            if self._shows_face(camera, middle, frames)
            else (1.0 - p.rate, 1.0 - p.false_rate)
        )
        self._odds = max(self._odds + float(np.log(share[0] / share[1])), 0.0)

    def _shows_face(self, camera: Camera, middle_m: Floats, frames: FrameSet) -> bool:
        depth_m = float(to_camera(camera, middle_m)[2])
        if depth_m <= 0.1:
            return False
        size_px = float(camera.K[0, 0]) * FACE_WIDTH * self._stature_m / depth_m
        x, y = project(camera, middle_m).tolist()
        pixels = frames.frames[camera.name].pixels
        h, w = pixels.shape[:2]
        reach = int((1.0 + _REACH) * size_px) + 2
        x0, y0, x1, y1 = (int(v) for v in (x - reach, y - reach, x + reach, y + reach))
        x0, y0, x1, y1 = max(x0, 0), max(y0, 0), min(x1, w), min(y1, h)
        if x1 - x0 < size_px or y1 - y0 < size_px:
            return False
        grey = np.asarray(cv2.cvtColor(pixels[y0:y1, x0:x1], cv2.COLOR_BGR2GRAY), np.uint8)
        return bool(
            faces_near(
                self._cascade, grey, x - x0, y - y0, size_px, _REACH * size_px, self._params.windows
            )
        )


def _away_rad(global_xyzw: Floats, camera: Camera, at_m: Floats) -> float:
    """Horizontal angle between the direction that a bone (4,) faces and that to the camera."""
    forward, eye = rotations.rotate(global_xyzw, _FORWARD), centre(camera) - at_m
    angle = np.arctan2(forward[0], forward[2]) - np.arctan2(eye[0], eye[2])
    return float(abs((angle + np.pi) % (2.0 * np.pi) - np.pi))
