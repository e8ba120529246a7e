"""A person on a television in the room: flat, and scaled to the screen."""

import numpy as np

from mocapd.sim.person_spec import Screen
from mocapd.types import Floats

_DEEP = 0.02  # share of a body's depth that remains, so that its surface keeps its order
_BEFORE_M = 0.02  # distance in front of the wall or stand


def on_screen(points_m: Floats, screen: Screen) -> Floats:
    """Screen positions (N,3) [m, world] of points (N,3) of a scene centred on its floor."""
    yaw = np.radians(screen.yaw_deg)
    right = np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
    ahead = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    scale = screen.height_m / screen.shows_m
    x, y, z = scale * points_m.T
    flat = x[:, None] * right + y[:, None] * np.array([0.0, 1.0, 0.0])
    before = (_DEEP * z + _BEFORE_M)[:, None] * ahead
    out: Floats = np.array(screen.base_m) + flat + before
    return out
