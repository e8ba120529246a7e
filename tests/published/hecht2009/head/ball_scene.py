"""Pictures of a patterned ball before a wall, by casting a ray through each pixel."""

from dataclasses import dataclass
from functools import cache

import numpy as np

from mocapd.geometry.camera_model import project, rays
from mocapd.types import Bytes, Camera, Floats

SKIN_BGR = np.array([95.0, 125.0, 190.0])
WALL_BGR = np.array([150.0, 140.0, 120.0])
SIZE_PX = (320, 240)


@dataclass(frozen=True)
class Ball:
    """A head: middle (3,) [m], radius [m]; with a bright face, 58 mm wide, towards +Z turned by yaw, if it has one."""

    middle_m: Floats
    radius_m: float = 0.1
    yaw_rad: float = 0.0
    has_face: bool = True


def camera(x_m: float, name: str, yaw_deg: float = 0.0, distance_m: float = 2.5) -> Camera:
    """At the height of a head; turned by yaw about the head's place, it looks at it from `distance_m`, x to its right."""
    c, s = np.cos(np.deg2rad(yaw_deg)), np.sin(np.deg2rad(yaw_deg))
    outwards, right = np.array([s, 0.0, c]), np.array([c, 0.0, -s])
    R = np.stack([right, [0.0, -1.0, 0.0], -outwards])
    centre = np.array([0.0, 1.5, 0.0]) + distance_m * outwards + x_m * right
    K = np.array([[300.0, 0.0, 159.5], [0.0, 300.0, 119.5], [0.0, 0.0, 1.0]])
    dist = np.array([-0.05, 0.02, 0.0005, -0.0005, 0.0])
    return Camera(name, SIZE_PX, K, dist, R, -R @ centre)


def narrow_pair() -> tuple[Camera, Camera]:
    """12 cm apart."""
    return camera(-0.06, "left"), camera(0.06, "right")


def wide_pair() -> tuple[Camera, Camera]:
    """1.7 m apart, 56 degrees between their views."""
    return camera(0.0, "left", -28.0, 1.8), camera(0.0, "right", 28.0, 1.8)


@cache
def _view(of: Camera) -> tuple[Floats, Floats, Floats]:
    """The camera's centre (3,), its rays (h,w,3), and the wall that they meet (h,w,3)."""
    w, h = SIZE_PX
    u, v = np.meshgrid(np.arange(w, dtype=float), np.arange(h, dtype=float))
    centre, directions = rays(of, np.stack([u, v], axis=-1))
    to_wall = (-4.0 - centre[2]) / directions[..., 2]
    x, y = (centre[i] + to_wall * directions[..., i] for i in (0, 1))
    shade = 0.8 + 0.05 * np.tanh(0.2 * x) + 0.02 * y
    return centre, directions, WALL_BGR * shade[..., None]


@cache
def _lit_wall(of: Camera, light: float) -> Bytes:
    return _levels(light * _view(of)[2])


def _levels(light: Floats) -> Bytes:
    return np.asarray(np.clip(light, 0, 255), np.uint8)


def picture(of: Camera, balls: tuple[Ball, ...], light: float = 1.0) -> Bytes:
    """What the camera sees (h,w,3) BGR of balls, the nearer before the farther, and a wall 4 m behind the origin."""
    centre, directions, _ = _view(of)
    out = _lit_wall(of, light).copy()
    for ball in sorted(balls, key=lambda b: -float(np.linalg.norm(b.middle_m - centre))):
        x, y = project(of, ball.middle_m).astype(int).tolist()
        reach = int(1.3 * 300.0 * ball.radius_m / float(np.linalg.norm(ball.middle_m - centre))) + 2
        part = slice(max(0, y - reach), y + reach + 1), slice(max(0, x - reach), x + reach + 1)
        _draw(ball, centre, directions[part], light, out[part])
    return out


def _draw(ball: Ball, centre: Floats, directions: Floats, light: float, out: Bytes) -> None:
    """A grain of a few millimetres, so that two views can be matched, and hair on the upper back."""
    to_middle = ball.middle_m - centre
    along = directions @ to_middle
    inside = ball.radius_m**2 - (to_middle @ to_middle - along**2)
    hit = inside > 0.0
    point = centre + (along - np.sqrt(np.maximum(inside, 0.0)))[..., None] * directions
    c, s = np.cos(ball.yaw_rad), np.sin(ball.yaw_rad)
    own = (point - ball.middle_m) @ np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
    x, y, z = np.moveaxis(own, -1, 0)
    grain = np.sin(190 * x + 40 * y) * np.sin(170 * y + 3.0) + np.sin(90 * z + 120 * x * y / 0.1)
    colour = SKIN_BGR * (0.7 + 0.06 * grain)[..., None]
    hair = y - 0.6 * z > 0.35 * ball.radius_m
    colour = np.where(hair[..., None], np.array([30.0, 40.0, 55.0]) * (1 + 0.15 * grain)[..., None], colour)  # fmt: skip
    if ball.has_face:
        face = (abs(x) < 0.029) & (abs(y) < 0.029) & (z > 0.0)
        colour = np.where(face[..., None], SKIN_BGR * 1.25, colour)
    out[hit] = _levels(light * colour[hit])
