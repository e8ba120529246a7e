"""Somebody passes close to one lens: the other cameras carry the body meanwhile."""

import numpy as np
import pytest

from mocapd.body.model import build_model
from mocapd.body.pose_space import full_body
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import initial_information
from mocapd.fit.solver import Fitter
from mocapd.shirt.garment import shirt_labels
from mocapd.sim.world import rig_of
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.track_state import BodyShapeEstimate, t_pose_state
from mocapd.types import Bytes
from tests.sim import small

pytestmark = pytest.mark.kernels


def room(seed: int, covered: bool) -> Bytes:
    rng = np.random.default_rng(seed)
    picture = rng.integers(110, 118, (240, 320, 3))
    if covered:
        picture[:, 40:] = rng.integers(20, 220, (240, 280, 3))
    return picture.astype(np.uint8)


@pytest.mark.parametrize(
    ("covered", "used"), [((), (0, 1)), ((1,), (0,)), ((0,), (1,)), ((0, 1), (0, 1))]
)
def test_a_covered_camera_tells_nothing_unless_all_are(
    covered: tuple[int, ...], used: tuple[int, ...]
) -> None:
    table = small.table()
    for camera in table["cameras"]:
        camera |= {"size_px": [320, 240], "dropped": 0.0, "clock_offset_s": 0.0}
    rig = rig_of(small.scenario(**table))
    body = build_model(1.75, full_body())
    views = CameraViews(
        Fitter(body, shirt_labels(body), rig.cameras, [1, 1], FitParams()), ClothesParams()
    )
    views.reset()
    wearer = BodyShapeEstimate(np.ones(body.n_shape), initial_information(body.space), 0.0)
    state, present = t_pose_state(body, body.rest_m[0].copy(), wearer), {0: 0.0, 1: 0.0}
    views.take({i: room(i, covered=False) for i in present}, present)
    views.mark_body(state)
    views.seed_background()
    views.take({i: room(7 + i, covered=i in covered) for i in present}, present)
    shown, looked = views.prepare(state, True, lambda i: i)
    assert tuple(view.index for view in shown) == used
    assert looked == [i for i in present if i not in covered]
