"""Which pixels see the floor about somebody."""

import numpy as np

from mocapd.geometry.camera_model import project
from mocapd.tracking.cues.clothes.camera_view import FloorView
from tests.geometry.rigs import looking_at

SCALE, ROI = 2, (20, 60, 300, 230)
CAMERA = looking_at("high", np.array([0.4, 2.2, 3.5]), np.array([0.0, 0.3, 0.0]), roll_rad=0.1)
ROOT_M = np.array([0.3, 0.95, -0.2])


def test_a_place_on_the_floor_is_near_within_a_metre_and_a_half() -> None:
    near = FloorView(CAMERA, SCALE).near(ROOT_M, ROI)
    x0, y0, x1, y1 = ROI
    assert near.shape == (y1 - y0, x1 - x0)
    across, along = np.meshgrid(np.linspace(-2.5, 2.5, 41), np.linspace(-2.5, 2.5, 41))
    floor_m = np.stack([ROOT_M[0] + across, np.zeros_like(across), ROOT_M[2] + along], axis=-1)
    away_m = np.hypot(across, along)
    told = {True: 0, False: 0}
    for place, distance_m in zip(floor_m.reshape(-1, 3), away_m.ravel(), strict=True):
        u, v = (project(CAMERA, place[None])[0] + 0.5) / SCALE - 0.5
        x, y = round(u) - x0, round(v) - y0
        if 0 <= x < x1 - x0 and 0 <= y < y1 - y0 and abs(distance_m - 1.5) > 0.05:
            assert near[y, x] == (distance_m < 1.5)
            told[bool(near[y, x])] += 1
    assert min(told.values()) > 20


def test_what_is_above_the_horizon_is_no_floor() -> None:
    low = looking_at("low", np.array([0.0, 1.2, 3.0]), np.array([0.0, 1.2, 0.0]), roll_rad=0.0)
    w, h = (side // SCALE for side in low.size_px)
    near = FloorView(low, SCALE).near(np.zeros(3), (0, 0, w, h))
    assert not near[: h // 2].any()
    assert near[h // 2 :].any()
