"""How far the outline of somebody without the shirt lies from the body: as far as the camera was turned."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.body.model import Shaper, build_model
from mocapd.body.pose_space import full_body
from mocapd.body.shape import BodyShape, mean_shape, skeleton_of
from mocapd.body.skeleton import joint_positions
from mocapd.calibrate.verification.check_measure import EVERY, Measure, MeasuringTracker
from mocapd.fit.fit_params import FitParams
from mocapd.fit.idmap_renderer import IdMapRenderer
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.work_size import image_scales
from mocapd.geometry import rotations
from mocapd.tracking.base import Probe, Track, no_probe
from mocapd.tracking.cues.clothes.regions import silhouette_labels
from mocapd.types import BodyState, Camera, Floats, Frame, FrameSet, Pose, Rig, Tracking
from tests.geometry.rigs import looking_at

pytestmark = pytest.mark.kernels

TURN_RAD = np.radians(1.0)
MARGIN_PX = 26
SHAPE = mean_shape(1.7)
RIG = Rig(
    tuple(
        looking_at(f"cam{i}", np.array([x, 1.5, 3.0]), np.array([0.0, 0.9, 0.0]))
        for i, x in enumerate((-1.0, 1.0))
    )
)


class Outlines:
    """Somebody stands in the T-pose, whose outline these cameras see; as a tracker."""

    name = "outlines"

    def __init__(self, cameras: tuple[Camera, ...]) -> None:
        self.probe: Probe = no_probe
        self._model = build_model(SHAPE.stature_m, full_body())
        scales = image_scales(cameras, FitParams().work_width_px)
        self._drawings = [
            IdMapRenderer(Shaper(self._model), silhouette_labels(self._model), camera, scale)
            for camera, scale in zip(cameras, scales, strict=True)
        ]

    def reset(self, near: BodyState | None = None) -> None:
        """Nothing is remembered."""

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """See Tracker."""
        skeleton, space = skeleton_of(shape), self._model.space
        n = len(skeleton.names)
        quats = np.tile(rotations.IDENTITY_XYZW, (n, 1))
        pose = Pose(skeleton.rest_m[0], quats)
        state = MotionState(
            pose.root_m, quats, np.zeros(self._model.n_pose), np.ones(space.n_shape), initial_information(space)
        )  # fmt: skip
        evidence, roi_px = {}, {}
        for drawing in self._drawings:
            roi = drawing.region(state, 0.0, MARGIN_PX)
            assert roi is not None
            evidence[drawing.camera.name] = 3 * drawing.render(
                state, 0.0, roi
            )  # some class of its own
            x0, y0, x1, y1 = (drawing.image_scale * edge for edge in roi)
            roi_px[drawing.camera.name] = x0, y0, x1, y1
        body = BodyState(
            frames.t_ns, Tracking.LIVE, self.name, pose, joint_positions(skeleton, pose), np.ones(n)
        )
        return Track(body, shape, 1.0, evidence, roi_px)


def measured(turn_rad: Floats) -> Measure:
    """By the rig, of what is seen when its second camera is turned by this [rad]."""
    first, second = RIG.cameras
    turn = rotations.to_matrix(rotations.exp(turn_rad))
    turned = replace(second, R=turn @ second.R, t_m=turn @ second.t_m)
    out: list[Measure] = []
    tracker = MeasuringTracker(Outlines((first, turned)), RIG, SHAPE, out.append, by_outline=True)
    black = np.zeros((480, 640, 3), np.uint8)
    for i in range(EVERY):
        frames = {name: Frame(name, i, i * 10**7, black) for name in RIG.names}
        tracker.step(FrameSet(i * 10**7, frames), SHAPE)
    assert len(out) == 1
    return out[0]


def test_outlines_of_the_true_rig_agree() -> None:
    measure = measured(np.zeros(3))
    for one in measure.cameras.values():
        assert np.linalg.norm(one.shift_px) < 0.3
        assert one.match > 0.98
    assert np.isnan(measure.lengths).all()
    assert measure.upright_rad < 0.2


@pytest.mark.parametrize("axis", [0, 1])
def test_an_outline_of_a_turned_camera_is_off_by_its_turn(axis: int) -> None:
    measure = measured(TURN_RAD * np.eye(3)[axis])
    away = measure.cameras["cam1"].shift_px
    expected_px = float(np.diag(RIG.cameras[1].K)[1 - axis] * np.tan(TURN_RAD))
    assert abs(away[1 - axis]) == pytest.approx(expected_px, rel=0.25)
    assert abs(away[axis]) < 0.25 * expected_px
    assert np.linalg.norm(measure.cameras["cam0"].shift_px) < 0.3
