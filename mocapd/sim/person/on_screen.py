"""Somebody who is not in the room but on its television: as large as the screen makes them, and flat."""

import numpy as np

from mocapd.sim.person_spec import Screen
from mocapd.types import Floats

_DEEP = 0.02  # of a body's depth is left, so that what is in front stays there
_BEFORE_M = 0.02  # before the wall, and whatever the screen hangs on


def on_screen(points_m: Floats, screen: Screen) -> Floats:
    """Where points (N,3) of a scene whose floor has its middle at the origin are shown (N,3) [m, world]."""
    yaw = np.radians(screen.yaw_deg)
    right = np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
    ahead = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    scale = screen.height_m / screen.shows_m
    x, y, z = scale * points_m.T
    flat = x[:, None] * right + y[:, None] * np.array([0.0, 1.0, 0.0])
    before = (_DEEP * z + _BEFORE_M)[:, None] * ahead
    out: Floats = np.array(screen.base_m) + flat + before
    return out
