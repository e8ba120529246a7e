"""The sheet's kernel against the same, ray by ray in numpy."""

import numpy as np
import pytest

from mocapd.geometry.camera_model import normalised
from mocapd.sim.board.board_picture import BoardFilm, PrintedBoard, print_picture
from mocapd.types import Floats
from tests.calibrate.board_scenes import cameras, held_poses

INK, PAPER = 0.04, 0.75


def naive(pixels: Floats, R: Floats, t_m: Floats, board: PrintedBoard) -> tuple[Floats, Floats]:
    """Cover and light along the rays of pixels (...,2), meeting the plane in the world."""
    camera = cameras(1)[0]
    rays = np.concatenate([normalised(camera, pixels), np.ones((*pixels.shape[:-1], 1))], axis=-1)
    eye = R.T @ (-camera.R.T @ camera.t_m - t_m)
    way = rays @ camera.R @ R
    length = -eye[2] / way[..., 2]
    x, y = (eye[i] + length * way[..., i] for i in (0, 1))
    x, y = x / board.square_m, y / board.square_m
    sheet = (length > 0) & (x > -1 / 3) & (y > -1 / 3)
    sheet &= (x < board.columns + 1 / 3) & (y < board.rows + 1 / 3)
    inside = sheet & (x >= 0) & (y >= 0) & (x < board.columns) & (y < board.rows)
    light = np.where(sheet, INK if board.inverted else PAPER, 0.0)
    if eye[2] < 0:  # before the printed side
        cell = print_picture(board)[
            (np.clip(y, 0, board.rows - 0.01) * 24).astype(int),
            (np.clip(x, 0, board.columns - 0.01) * 24).astype(int),
        ]
        light[inside] = np.where(cell == 0, INK, PAPER)[inside]
    return sheet.astype(float), light


@pytest.mark.parametrize(("turned", "inverted"), [(False, False), (True, True)])
def test_the_layer_is_that_of_rays_through_nine_points_of_a_pixel(
    turned: bool, inverted: bool
) -> None:
    board = PrintedBoard(5, 6, 0.07, 0.052, "DICT_4X4_1000", inverted=inverted)
    camera = cameras(1)[0]
    R, t_m = held_poses(2)[1]
    if turned:  # shows its back
        R, t_m = R @ np.diag([-1.0, 1.0, -1.0]), t_m + R @ [0.35, 0.0, 0.0]
    layer = BoardFilm(camera, board).layer(R, t_m)
    rows, columns = layer.region
    x, y = np.meshgrid(np.arange(columns.start, columns.stop), np.arange(rows.start, rows.stop))
    x, y = x[: layer.cover.shape[0], : layer.cover.shape[1]], y[: layer.cover.shape[0]]
    y = y[:, : layer.cover.shape[1]]
    parts = [
        naive(np.stack([x + dx, y + dy], axis=-1).astype(float), R, t_m, board)
        for dx in (-1 / 3, 0.0, 1 / 3)
        for dy in (-1 / 3, 0.0, 1 / 3)
    ]
    cover, light = (np.mean(part, axis=0) for part in zip(*parts, strict=True))
    # within a pixel the film takes the lens for linear: a ray at an edge may fall on its other side
    assert np.mean(np.abs(layer.cover - cover) > 1e-9) < 0.002
    assert np.mean(np.abs(layer.light - light) > 1e-9) < 0.01
    assert layer.cover.max() == 1.0
    assert (layer.light <= layer.cover + 1e-12).all()
