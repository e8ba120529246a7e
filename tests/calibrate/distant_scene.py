"""A room so far away that only turns of the camera move it, and somebody before it."""

from dataclasses import dataclass, field
from functools import cache

import cv2
import numpy as np

from mocapd.geometry import rotations
from mocapd.geometry.camera_model import normalised
from mocapd.types import Bytes, Camera, Floats, Singles

SIZE_PX = (320, 240)
FOCAL_PX = 275.0
_CANVAS = 800
AXES = {"pitch": 0, "yaw": 1, "roll": 2}


def camera(name: str = "left", k1: float = 0.0) -> Camera:
    K = np.array([[FOCAL_PX, 0.0, 159.5], [0.0, FOCAL_PX, 119.5], [0.0, 0.0, 1.0]])
    return Camera(name, SIZE_PX, K, np.array([k1, 0.0, 0.0, 0.0, 0.0]), np.eye(3), np.zeros(3))


def turn(axis: str, degrees: float) -> Floats:
    """A rotation vector (3,) [rad] about one axis of the camera."""
    out = np.zeros(3)
    out[AXES[axis]] = np.deg2rad(degrees)
    return out


@cache
def _rays(k1: float) -> Floats:
    """(height,width,3): where each pixel of such a lens looks, at a distance of 1."""
    w, h = SIZE_PX
    x, y = np.meshgrid(np.arange(w, dtype=float), np.arange(h, dtype=float))
    xy = normalised(camera(k1=k1), np.stack([x, y], axis=-1))
    return np.concatenate([xy, np.ones((h, w, 1))], axis=-1)


@cache
def _places_px(k1: float, turned_rad: tuple[float, ...]) -> Singles:
    """(2,height,width): which place of the canvas each pixel shows after a turn."""
    before = _rays(k1) @ rotations.to_matrix(rotations.exp(np.array(turned_rad)))
    places = before[..., :2] / before[..., 2:] * FOCAL_PX + _CANVAS / 2
    return np.moveaxis(places, -1, 0).astype(np.float32, order="C")


@dataclass
class Room:
    """Walls with blobs on them, seen through one lens."""

    camera: Camera
    seed: int = 0
    canvas: Bytes = field(init=False)
    person: Bytes = field(init=False)

    def __post_init__(self) -> None:
        rng = np.random.default_rng(self.seed)
        coarse = rng.integers(40, 216, (_CANVAS // 20, _CANVAS // 20, 3)).astype(np.uint8)
        size = (_CANVAS, _CANVAS)
        self.canvas = np.asarray(cv2.resize(coarse, size, interpolation=cv2.INTER_CUBIC), np.uint8)
        shirt = rng.integers(0, 256, (12, 6, 3)).astype(np.uint8)
        self.person = np.asarray(
            cv2.resize(shirt, (90, 180), interpolation=cv2.INTER_NEAREST), np.uint8
        )
        self._rng = rng

    def picture(
        self,
        turned_rad: Floats | None = None,
        person_px: tuple[int, int] | None = None,
        light: float = 1.0,
    ) -> Bytes:
        """What the camera shows after a turn, with somebody's upper left corner at `person_px`."""
        turned = (0.0, 0.0, 0.0) if turned_rad is None else tuple(turned_rad.tolist())
        x_px, y_px = _places_px(float(self.camera.dist[0]), turned)
        seen = cv2.remap(self.canvas, x_px, y_px, cv2.INTER_LINEAR)
        out = np.asarray(seen, dtype=np.float32)
        if person_px is not None:
            x, y = person_px
            h, w = (min(SIZE_PX[1] - y, 180), min(SIZE_PX[0] - x, 90))
            out[y : y + h, x : x + w] = self.person[:h, :w]
        out *= light
        out += 3.0 * self._rng.standard_normal(out.shape, dtype=np.float32)
        picture: Bytes = np.clip(out, 0, 255).astype(np.uint8)
        return picture
