"""Keypoint detection: runs the heatmap network of each camera on a crop about the predicted body."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.skeleton import INDEX
from mocapd.fit.motion_state import MotionState, predict_state
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointRays, JointTerm
from mocapd.geometry.camera_model import to_camera, undistort
from mocapd.geometry.rotations import rotate
from mocapd.tracking.cues.clothes.camera_view import CameraView
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import KeypointDetectionParams
from mocapd.types import Bytes, Floats, Singles
from mocapd.vision.heatmaps.joint_network import (
    CELLS,
    INPUT_PX,
    JOINTS,
    MARKS,
    SIDE_M,
    STATURE_M,
    JointNetwork,
)
from mocapd.vision.heatmaps.person_crop import PersonCrop, crop_about, middle_of

_JOINTS, _HIPS_MAP = np.array([INDEX[name] for name in JOINTS]), JOINTS.index("hips")
_HIPS, _NECK = INDEX["hips"], INDEX["neck"]
_NEAREST_M = 0.5
_ITERATIONS = 5  # of undistortion: no keypoint is accurate to a thousandth of a pixel
_CELL_PX = INPUT_PX / CELLS
_GREY = (127.5, 127.5, 127.5)


@dataclass(frozen=True, slots=True, eq=False)
class CameraKeypoints:
    """One camera's detection: its rays, and log-odds (96,96) of the person in a crop of the picture."""

    rays: JointRays
    odds: Singles
    crop: PersonCrop


def no_detection(_camera: int) -> JointRays | None:
    """Detects nothing, for frame sets without keypoint detection."""
    return None


class KeypointDetectors:
    """A network for each camera."""

    def __init__(self, count: int, stature_m: float, params: KeypointDetectionParams) -> None:
        """count: of cameras."""
        n_networks = count if params.term.weight > 0.0 else 0
        self._networks = [JointNetwork() for _ in range(n_networks)]
        self._relative_size, self._params = stature_m / STATURE_M, params

    def detector(
        self,
        fitter: Fitter,
        predicted: MotionState,
        cameras: CameraViews,
        found: dict[int, CameraKeypoints] | None = None,
    ) -> Callable[[int], JointRays | None]:
        """Returns a function that detects the keypoints of the predicted body in the camera of an index, and marks the person
        in its picture. found: gets the detections, by camera."""
        here = fitter.joints(predicted)

        def detect(i: int) -> JointRays | None:
            one = self.detect(fitter, predicted, here, cameras, i)
            if one is None:
                return None
            if found is not None:
                found[i] = one
            cameras.each[i].mark_person(one.odds, one.crop)
            return one.rays

        return detect

    def detect(
        self,
        fitter: Fitter,
        body: MotionState,
        joints: tuple[Floats, Floats],
        cameras: CameraViews,
        index: int,
        knows_room: bool = True,
    ) -> CameraKeypoints | None:
        """Detects the keypoints of a body in one picture; None too near to the camera, or without its picture: a search may
        have begun with a camera that is absent now. joints: its centres (J,3) and rotations (J,4); knows_room: the background
        tells the room from the person, else it is not looked at."""
        if not self._networks or index not in cameras.present:
            return None
        late_s, there_m = cameras.present[index], joints[0]
        if late_s:
            there_m, _ = fitter.joints(predict_state(fitter.model, body, late_s))
        return self._detect(fitter, index, cameras.each[index], joints, there_m, knows_room)

    def term(
        self, model: BodyModel, rays: Iterable[JointRays | None], share: float = 1.0
    ) -> tuple[JointTerm, ...]:
        """The detections as a term of the fit, with this share of its weight; empty without detections."""
        found = [camera_rays for camera_rays in rays if camera_rays is not None]
        return (JointTerm(model, found, self._params.term.weighing(share)),) if found else ()

    def _detect(
        self,
        fitter: Fitter,
        index: int,
        view: CameraView,
        here: tuple[Floats, Floats],
        there_m: Floats,
        knows_room: bool,
    ) -> CameraKeypoints | None:
        """here: joints (J,3) and rotations (J,4) at the frame set's instant; there_m (J,3): joints at the camera's own."""
        p, size, drawing = self._params, self._relative_size, fitter.drawings[index]
        camera, k = drawing.camera, drawing.image_scale
        in_camera = to_camera(camera, there_m)
        middle = middle_of(in_camera[_HIPS], in_camera[_NECK])
        if middle[2] < _NEAREST_M:
            return None
        crop = crop_about(camera, middle, SIDE_M * size, INPUT_PX, k)
        heatmaps = self._networks[index].detect(*_cut_out(view, crop, knows_room))
        crop_px = heatmaps.at_cells * _CELL_PX + (_CELL_PX / 2 - 0.5)
        frame_px = ((crop_px - crop.corner_px) / crop.scale + 0.5) * k - 0.5
        distorted = (frame_px - camera.K[:2, 2]) / camera.K[[0, 1], [0, 1]]
        xy = undistort(camera.dist, distorted, _ITERATIONS)
        # what moved until this camera's own exposure
        moved_m = in_camera - to_camera(camera, here[0])
        xy = xy - moved_m[_JOINTS, :2] / middle[2]
        # from what the network marks to the joint
        marks_m = STATURE_M * size * rotate(here[1][_JOINTS], MARKS) @ camera.R.T
        xy = xy - (marks_m[:, :2] - xy * marks_m[:, 2:]) / middle[2]
        farther_m = size * heatmaps.farther_m - (marks_m[:, 2] - marks_m[_HIPS_MAP, 2])
        inside = (
            (heatmaps.at_cells > p.inside_cells) & (heatmaps.at_cells < CELLS - 1 - p.inside_cells)
        ).all(axis=1)
        inside &= ((frame_px >= 0) & (frame_px < camera.size_px)).all(axis=1)
        cell_m = SIDE_M * size / CELLS
        information = _inverse(heatmaps.spread_cells2, p) / cell_m**2
        sd_m = np.maximum(p.laplace * heatmaps.scale_m * size, p.least_depth_m)
        rays = JointRays(
            camera, _JOINTS[inside], xy[inside], information[inside],
            farther_m[inside], (1.0 / sd_m**2)[inside],
        )  # fmt: skip
        return CameraKeypoints(rays, heatmaps.mask_odds, crop)


def _cut_out(view: CameraView, crop: PersonCrop, knows_room: bool) -> tuple[Bytes, Singles, Bytes]:
    """Crops of the picture, of the background and of its mask of learned pixels, none unless it `knows_room`."""
    M, size = crop.affine, (INPUT_PX, INPUT_PX)
    room, learned_mask = view.background.empty_room()
    picture = cv2.warpAffine(view.picture, M, size, flags=cv2.INTER_LINEAR, borderValue=_GREY)
    background = cv2.warpAffine(room, M, size, flags=cv2.INTER_LINEAR, borderValue=_GREY)
    if not knows_room:
        learned_mask = np.zeros_like(learned_mask)
    is_learned = cv2.warpAffine(learned_mask, M, size, flags=cv2.INTER_NEAREST, borderValue=(0,))
    return (
        np.asarray(picture, np.uint8),
        np.asarray(background, np.float32),
        np.asarray(is_learned, np.uint8),
    )


def _inverse(spread_cells2: Floats, p: KeypointDetectionParams) -> Floats:
    """Information (J,3) of spreads (J,3), both xx, xy, yy."""
    xx = np.maximum(spread_cells2[:, 0] - p.blur_cells2, 0.0) + p.least_cells2
    yy = np.maximum(spread_cells2[:, 2] - p.blur_cells2, 0.0) + p.least_cells2
    xy = np.clip(spread_cells2[:, 1], -0.9 * np.sqrt(xx * yy), 0.9 * np.sqrt(xx * yy))
    determinant = xx * yy - xy * xy
    return np.stack([yy / determinant, -xy / determinant, xx / determinant], axis=1)
