"""Pictures of the board in the scenario's room, in the light of its lamps."""

from collections.abc import Sequence

import cv2
import numpy as np

from mocapd.sim.board.board_path import BoardPlace
from mocapd.sim.board.board_picture import BoardFilm, PrintedBoard
from mocapd.sim.renderer import CameraRenderer
from mocapd.sim.scenery.lamps import Lamps
from mocapd.types import Bytes, Floats

_BLUR_PX = 0.35  # of a webcam's lens in focus


class BoardShots:
    """One camera's pictures of one board. Used by one thread."""

    def __init__(self, renderer: CameraRenderer, lamps: Lamps, board: PrintedBoard) -> None:
        self._renderer, self._lamps, self._board = renderer, lamps, board
        self._film = BoardFilm(renderer.camera, board)
        width, height = renderer.camera.size_px
        self._colour = np.zeros((height, width, 3), dtype=np.float32)
        self._cover = np.zeros((height, width), dtype=np.float32)

    def pictures(self, place: BoardPlace | None, noise_keys: Sequence[int]) -> list[Bytes]:
        """(H,W,3) BGR each, alike but for the noise, with the board at this place; None: nothing."""
        self._colour[:] = 0.0
        self._cover[:] = 0.0
        if place is not None:
            R, t_m = place.pose(self._board)
            layer = self._film.layer(R, t_m)
            if layer.cover.size:  # empty where the board is outside this camera's picture
                falling = irradiance(self._lamps, place.middle_m, -R[:, 2])
                light, cover = (
                    cv2.GaussianBlur(part, (0, 0), _BLUR_PX) for part in (layer.light, layer.cover)
                )
                self._colour[layer.region] = light[..., None] * falling
                self._cover[layer.region] = cover
        levels = np.ones(len(self._lamps.at_m))
        return [
            self._renderer.picture_of(self._colour, self._cover, levels, key) for key in noise_keys
        ]


def irradiance(lamps: Lamps, at_m: Floats, normal: Floats) -> Floats:
    """Linear RGB (3,) that falls on a flat thing at at_m (3,) with a unit normal (3,); no shadows."""
    up = 0.5 + 0.5 * normal[1]
    total: Floats = up * lamps.ambient_up + (1.0 - up) * lamps.ambient_down
    for lamp_m, rgb, sun in zip(lamps.at_m, lamps.rgb, lamps.sun, strict=True):
        way = lamp_m if sun else lamp_m - at_m
        square = float(way @ way)
        cosine = max(float(normal @ way), 0.0) / np.sqrt(square)
        total = total + rgb * cosine / (1.0 if sun else max(square, 0.04))
    return total
