"""The picture of the empty room, one layer per lamp, so that any lighting is a weighted sum."""

from dataclasses import dataclass

import numpy as np

from mocapd.geometry.camera_model import rays
from mocapd.sim.scenery.furniture import Primitives
from mocapd.sim.scenery.lamps import Lamps
from mocapd.sim.scenery.room_kernels import cast_room
from mocapd.types import Camera, Floats, Singles

# Offsets of the samples inside a pixel [px]
_SAMPLES = ((-0.167, -0.333), (0.333, 0.0), (-0.167, 0.333))


@dataclass(frozen=True, slots=True, eq=False)
class Background:
    """layers (L+1,H,W,3) linear RGB: ambient, then each lamp at level 1; points_m (H,W,3), NaN: sky."""

    layers: Singles
    points_m: Singles

    def lit(self, levels: Floats) -> Singles:
        """The empty room (H,W,3) linear RGB with the lamps at these levels (L,)."""
        out: Singles = self.layers[0].copy()
        for level, layer in zip(levels, self.layers[1:], strict=True):
            if level:
                out += np.float32(level) * layer
        return out


def render_background(
    camera: Camera, room: Primitives, lamps: Lamps, sky: Floats, samples: int = 3
) -> Background:
    """Cast `samples` (1..3) rays per pixel through the camera's lens."""
    width, height = camera.size_px
    layers = np.zeros((1 + len(lamps.at_m), height, width, 3), dtype=np.float32)
    points = np.empty((height, width, 3), dtype=np.float32)
    x, y = np.meshgrid(np.arange(width, dtype=float), np.arange(height, dtype=float))
    origin, centre = rays(camera, np.stack([x, y], axis=-1))
    down, right = np.gradient(centre, axis=(0, 1))
    for i, (dx, dy) in enumerate(_SAMPLES[:samples]):
        # within a pixel the lens is linear; the tilt of the unit length is of second order
        directions = centre + dx * right + dy * down
        cast_room(
            origin, directions.astype(np.float32), room, lamps, sky, i, layers, points,
        )  # fmt: skip
    layers /= samples
    return Background(layers, points)
