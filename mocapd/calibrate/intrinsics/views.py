"""Chooses views of the board for the intrinsics: sharp ones that together fill the picture."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.types import Floats

GRID = (8, 6)  # cells across and down in which coverage is counted
_LEAST_SHARPNESS = 0.5  # of the 90th percentile of all views


def coverage(views: Sequence[BoardView], size_px: tuple[int, int]) -> NDArray[np.int64]:
    """(rows, columns) of the grid over the picture: how many corners are in each cell."""
    counts = np.zeros((GRID[1], GRID[0]), np.int64)
    for view in views:
        column, row = _cells(view.corners_px, size_px)
        np.add.at(counts, (row, column), 1)
    return counts


def covered_share(views: Sequence[BoardView], size_px: tuple[int, int]) -> float:
    """The share of the picture's cells, 0..1, with a corner in any view."""
    return float(np.mean(coverage(views, size_px) > 0))


def _cells(corners_px: Floats, size_px: tuple[int, int]) -> tuple[NDArray[np.int64], ...]:
    cells = np.floor(corners_px / np.array(size_px) * np.array(GRID)).astype(np.int64)
    cells = np.clip(cells, 0, np.array(GRID) - 1)
    return cells[:, 0], cells[:, 1]


def choose_views(
    views: Sequence[BoardView], size_px: tuple[int, int], most: int
) -> list[BoardView]:
    """At most `most` sharp views, chosen greedily: each adds most to those before it.

    A view adds corners in cells that have few as yet, and a shape of the board (its place, size and slant in the
    picture) unlike those chosen. In the order of their index.
    """
    sharpness = [view.sharpness for view in views]
    limit = _LEAST_SHARPNESS * float(np.percentile(sharpness, 90)) if views else 0.0
    rest = [view for view in views if view.sharpness >= limit]
    if len(rest) <= most:
        return rest
    shapes = np.stack([_shape(view, size_px) for view in rest])
    counts = np.zeros((GRID[1], GRID[0]))
    distance = np.full(len(rest), 1.0)  # from the nearest chosen shape
    chosen: list[int] = []
    for _ in range(most):
        gain = np.array([_gain(view, counts, size_px) for view in rest])
        score = (0.2 + gain) * distance * [view.sharpness for view in rest]
        score[chosen] = -1.0
        best = int(np.argmax(score))
        chosen.append(best)
        column, row = _cells(rest[best].corners_px, size_px)
        np.add.at(counts, (row, column), 1.0)
        distance = np.minimum(distance, np.linalg.norm(shapes - shapes[best], axis=1))
    return [rest[i] for i in sorted(chosen)]


def _gain(view: BoardView, counts: Floats, size_px: tuple[int, int]) -> float:
    column, row = _cells(view.corners_px, size_px)
    return float(np.mean(1.0 / (1.0 + counts[row, column])))


def _shape(view: BoardView, size_px: tuple[int, int]) -> Floats:
    """(5,): middle of the corners and the spread of them along and across, in picture widths."""
    xy = view.corners_px / size_px[0]
    spread = np.cov(xy.T)
    root = np.sqrt(np.diag(spread))
    return np.array([*xy.mean(axis=0), *root, spread[0, 1] / max(root.max(), 1e-9)])
