"""Pictures of a calibration board through a camera, each pixel traced back to the board's plane.

Shares nothing with the code that finds boards: the squares and markers are drawn from their own
definition, and only the bits of the markers come from OpenCV's tables.
"""

from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.geometry.camera_model import normalised, project
from mocapd.sim.board.board_kernels import PixelRays, shade_sheet
from mocapd.types import Bytes, Camera, Floats

_SUBSAMPLES = 3  # across a pixel and down it
_INK, _PAPER, _WALL = 0.04, 0.75, 0.18  # linear light
_GAMMA = 2.2
_CELLS = 24  # of the printed picture, per square


@dataclass(frozen=True, slots=True)
class PrintedBoard:
    """Squares and markers as printed; a `dictionary` of "" is a plain chessboard.

    The first square, at the left end of the top row, is black; in the `legacy` layout of a ChArUco
    board with an even number of rows it is white. Markers are in the white squares, numbered row
    by row. The margin is a third of a square.

    `two_sided`: the back bears the mirror image, `thickness_m` behind the front, its middle shifted by
    `back_shift_m` along the rows and down them, and turned about it by `back_turn_rad` from x to y.
    """

    columns: int
    rows: int
    square_m: float
    marker_m: float = 0.0
    dictionary: str = ""
    inverted: bool = False
    legacy: bool = False
    two_sided: bool = False
    thickness_m: float = 0.0
    back_shift_m: tuple[float, float] = (0.0, 0.0)
    back_turn_rad: float = 0.0


@dataclass(frozen=True, slots=True)
class BoardLight:
    """What the picture suffers: blur and noise (standard deviations, px and grey values), light 0..1."""

    blur_px: float = 0.7
    noise: float = 2.0
    brightness: float = 1.0


def print_picture(board: PrintedBoard) -> Bytes:
    """The print as a picture with `_CELLS` pixels a square and no margin: 1 paper, 0 ink."""
    first_white = board.legacy and board.rows % 2 == 0
    rows, columns = np.indices((board.rows, board.columns))
    white = (rows + columns) % 2 == (0 if first_white else 1)
    # a whole number of pixels per cell, so that the marker is cut exactly where it is printed
    picture = np.kron(white, np.ones((_CELLS, _CELLS))).astype(np.uint8)
    if board.dictionary:
        dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, board.dictionary))
        side = round(_CELLS * board.marker_m / board.square_m)
        edge = (_CELLS - side) // 2
        bits_across = dictionary.markerSize + 2
        cell = np.arange(side) * bits_across // side
        for marker, (row, column) in enumerate(np.argwhere(white)):
            bits = cv2.aruco.generateImageMarker(dictionary, marker, bits_across) > 0
            y, x = _CELLS * row + edge, _CELLS * column + edge
            picture[y : y + side, x : x + side] = bits[np.ix_(cell, cell)]
    return 1 - picture if board.inverted else picture


@dataclass(frozen=True, slots=True, eq=False)
class BoardLayer:
    """The sheet alone, in a part of the picture, rows and columns: how much of each pixel it covers,
    (h,w) 0..1, and the light that it gives back there per light that falls on it, (h,w) 0..cover."""

    region: tuple[slice, slice]
    cover: Floats
    light: Floats


class BoardFilm:
    """Pictures of one board through one camera. Two with the same arguments are the same."""

    def __init__(self, camera: Camera, board: PrintedBoard) -> None:
        width, height = camera.size_px
        y, x = np.mgrid[0:height, 0:width]
        self._camera = camera
        self._rays = normalised(camera, np.stack([x, y], axis=-1).astype(float))
        # the lens is smooth: within a pixel its map is a plane
        self._down: Floats = np.gradient(self._rays, axis=0)
        self._across: Floats = np.gradient(self._rays, axis=1)
        self._board = board
        self._print = print_picture(board)

    def picture(
        self, R: Floats, t_m: Floats, light: BoardLight | None = None, seed: int = 0
    ) -> Bytes:
        """(height, width, 3) uint8 BGR before a plain wall; R (3,3), t_m (3,) are world_from_board.

        The board's frame is x right, y down, z into the board, its origin at the outer corner of
        the first square. From behind a board of one side shows blank paper.
        """
        light = light or BoardLight()
        layer = self.layer(R, t_m)
        total: Floats = np.full(self._rays.shape[:2], _WALL)
        total[layer.region] = layer.light + (1.0 - layer.cover) * _WALL
        linear: Floats = light.brightness * total
        if light.blur_px > 0.0:
            linear = cv2.GaussianBlur(linear, (0, 0), light.blur_px).astype(float, copy=False)
        grey = 255.0 * np.clip(linear, 0.0, 1.0) ** (1.0 / _GAMMA)
        rng = np.random.default_rng([seed, 11])
        noisy = grey[..., None] + light.noise * rng.standard_normal((*grey.shape, 3))
        return np.clip(np.round(noisy), 0, 255).astype(np.uint8)

    def layer(self, R: Floats, t_m: Floats) -> BoardLayer:
        """The sheet at world_from_board R (3,3), t_m (3,), to be laid over another picture."""
        camera_R = self._camera.R @ R
        camera_t = self._camera.R @ t_m + self._camera.t_m
        # the camera sees the front if the board's z points away from it
        front = bool(camera_R[:, 2] @ camera_t > 0.0)
        if self._board.two_sided and not front:
            camera_R, camera_t = self._behind(camera_R, camera_t)
        board_from_ray = np.linalg.inv(np.column_stack([camera_R[:, :2], camera_t]))
        region = self._region(camera_R, camera_t)
        rays, down, across = self._rays[region], self._down[region], self._across[region]
        cover, light = np.zeros(rays.shape[:2]), np.zeros(rays.shape[:2])
        blank = _INK if self._board.inverted else _PAPER
        shade_sheet(
            PixelRays(rays, down, across), board_from_ray, self._board.square_m, self._print, _CELLS,
            _SUBSAMPLES, _INK, _PAPER, blank, front or self._board.two_sided, cover, light,
        )  # fmt: skip
        return BoardLayer(region, cover, light)

    def _behind(self, R: Floats, t_m: Floats) -> tuple[Floats, Floats]:
        """camera_from_back of the camera_from_board R, t_m: from behind, the print is mirrored."""
        board = self._board
        c, s = np.cos(board.back_turn_rad), np.sin(board.back_turn_rad)
        turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        middle_m = 0.5 * board.square_m * np.array([board.columns, board.rows, 0.0])
        back_m = middle_m + [*board.back_shift_m, board.thickness_m] - turn @ middle_m
        return R @ turn, t_m + R @ back_m

    def _region(self, R: Floats, t_m: Floats) -> tuple[slice, slice]:
        """Rows and columns of the picture that hold the whole sheet; camera_from_board R, t_m."""
        size_m = np.array([self._board.columns, self._board.rows]) * self._board.square_m
        edge_m = 0.4 * self._board.square_m
        corners = np.array([[x, y, 0.0] for x in (0.0, 1.0) for y in (0.0, 1.0)])
        corners[:, :2] = corners[:, :2] * (size_m + 2 * edge_m) - edge_m
        world_R, world_t = self._camera.R.T @ R, self._camera.R.T @ (t_m - self._camera.t_m)
        pixels = project(self._camera, corners @ world_R.T + world_t)
        if not np.isfinite(pixels).all():  # part of it is behind the camera
            return slice(None), slice(None)
        low = np.maximum(np.floor(pixels.min(axis=0)).astype(int) - 12, 0)
        high = np.maximum(np.ceil(pixels.max(axis=0)).astype(int) + 12, 0)
        return slice(low[1], high[1]), slice(low[0], high[0])
