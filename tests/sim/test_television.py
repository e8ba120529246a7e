"""Somebody on a television of the simulated room: moves, has the size of the screen, and is flat."""

from typing import Any

import numpy as np

from mocapd.geometry.camera_model import project
from mocapd.sim.person.group import on_screen
from mocapd.sim.person_spec import Screen
from mocapd.sim.renderer import CameraRenderer, camera_renderers
from mocapd.sim.world import World
from tests.sim.small import scenario

BASE_M, HEIGHT_M = (0.6, 0.8, -1.2), 0.8
SHOWN: dict[str, Any] = {
    "screen": {"base_m": list(BASE_M), "height_m": HEIGHT_M},
    "body": {"whole": True, "stature_m": 1.8},
    "motion": {
        "keyframes": [{"t_s": 0.0, "pose": "relaxed"}, {"t_s": 1.0, "pose": "arms_up"}],
    },
}


def renderers() -> list[CameraRenderer]:
    return camera_renderers(World(scenario(others=[SHOWN], person_appears_s=1.9)), samples=1)


def test_points_of_the_scene_lie_in_the_plane_of_the_screen() -> None:
    screen = Screen(base_m=(1.0, 0.5, -2.0), height_m=1.0, shows_m=2.0, yaw_deg=90.0)
    there = on_screen(np.array([[0.0, 0.0, 0.0], [0.0, 2.0, 0.0], [1.0, 1.0, 0.4]]), screen)
    np.testing.assert_allclose(there[:, 1], [0.5, 1.5, 1.0])
    np.testing.assert_allclose(there[:, 0], 1.0, atol=0.03)  # it faces +X
    np.testing.assert_allclose(there[2, 2], -2.5)  # the scene's right is on its right


def test_the_person_on_it_is_seen_where_it_hangs_and_moves() -> None:
    for renderer in renderers():
        _, person, other = renderer.labels_at(0.2)
        assert not person.any()
        rows, columns = np.nonzero(other)
        top = project(renderer.camera, np.array([BASE_M]) + [0.0, 0.9 * HEIGHT_M, 0.0])[0]
        foot = project(renderer.camera, np.array([BASE_M]))[0]
        assert abs(rows.min() - top[1]) < 3
        assert abs(rows.max() - foot[1]) < 3
        assert abs(columns.mean() - foot[0]) < 5
        later = renderer.labels_at(1.0)[2]
        assert np.count_nonzero(later != other) > 0.2 * np.count_nonzero(other)
