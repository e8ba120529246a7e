"""A scenario small enough for tests: two cameras of 160x120, a bare room, one loop of two seconds.

The renderer is imported when something is drawn: its kernels take longer to import than the films of most tests to read.
"""

import copy
from functools import cache
from typing import TYPE_CHECKING, Any

from mocapd.sim.scenario import Scenario, scenario_from_dict
from mocapd.sim.world import World

if TYPE_CHECKING:
    from mocapd.sim.renderer import CameraRenderer

LAMP_OFF_S, LAMP_ON_S = 0.8, 1.4

TABLE: dict[str, Any] = {
    "name": "small",
    "seed": 5,
    "fps_hz": 30.0,
    "loop_s": 2.0,
    "cameras": [
        {
            "name": "left",
            "position_m": [-1.5, 1.4, 2.6],
            "look_at_m": [0.0, 1.0, 0.0],
            "size_px": [160, 120],
            "dist": [-0.1, 0.02, 0.0005, -0.0005, 0.0],
        },
        {
            "name": "right",
            "position_m": [1.5, 1.3, 2.6],
            "look_at_m": [0.0, 1.0, 0.0],
            "size_px": [160, 120],
            "clock_offset_s": 0.011,
            "dropped": 0.3,
        },
    ],
    "lights": [
        {
            "name": "warm",
            "position_m": [1.5, 2.0, 1.8],
            "colour": [1.0, 0.7, 0.4],
            "intensity": 4.0,
            "events": [{"t_s": LAMP_OFF_S, "level": 0.0}, {"t_s": LAMP_ON_S, "level": 1.0}],
        },
        {
            "name": "cool",
            "position_m": [-1.5, 2.2, 1.8],
            "colour": [0.7, 0.8, 1.0],
            "intensity": 3.0,
        },
    ],
    "room": {
        "things": [
            {
                "kind": "box",
                "base_m": [-1.0, 0.0, -1.5],
                "size_m": [0.5, 0.8, 0.5],
                "yaw_deg": 20.0,
            },
            {"kind": "ball", "base_m": [1.0, 0.0, -1.0], "size_m": [0.5, 0.5, 0.5]},
        ]
    },
    "motion": {
        "keyframes": [
            {"t_s": 0.0, "pose": "t_pose"},
            {"t_s": 0.7, "pose": "crossed", "at_m": [0.2, 0.1], "yaw_deg": 30.0},
            {"t_s": 1.3, "pose": "arms_up", "at_m": [-0.1, 0.0], "yaw_deg": -20.0},
        ]
    },
}


def table(**changes: Any) -> dict[str, Any]:
    """The scenario's table with top-level keys changed."""
    return copy.deepcopy(TABLE) | changes


def scenario(**changes: Any) -> Scenario:
    return scenario_from_dict(table(**changes))


@cache
def renderers() -> "tuple[CameraRenderer, ...]":
    """Renderers of the unchanged scenario, made once."""
    from mocapd.sim.renderer import camera_renderers

    return tuple(camera_renderers(World(scenario())))
