"""Selects live views of the board for the intrinsics, and says what is missing as yet."""

from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.intrinsics.intrinsics import board_pose, usual_camera_matrix
from mocapd.calibrate.intrinsics.views import coverage
from mocapd.types import Floats

_TURN = 0.5  # a rotation by 1 rad is as new as a shift by half the picture's width
_SIZE = 0.3  # and so is a board e times as large
# for picking a picture
_MOST_MOTION = 0.004  # of corners, from picture to picture at 30 Hz [parts of the picture's width]
_LEAST_SHARPNESS = 0.6  # of the sharper picked ones
_NEW_PLACE = 0.13  # distance from the picked ones [picture widths]
_NEW_CELLS = 3  # of the coverage map; so many are reason enough to pick a picture
_MOST = 40
# for having enough
_ENOUGH = 10
_COVERED = 0.5
_SLANT = 0.5  # spread of the board's normals, to the sides and up and down [rad, about]


class Lack(StrEnum):
    """What is missing most."""

    PICTURES = "pictures"
    PLACES = "places"
    SIDEWAYS = "sideways"
    UPWARDS = "upwards"
    NOTHING = "nothing"


class PickedViews:
    """The picked pictures of one camera."""

    def __init__(self, size_px: tuple[int, int], board_m: Floats) -> None:
        self.size_px = size_px
        self.views: list[BoardView] = []
        self._board_m = board_m
        self._places = np.zeros((0, 5))
        self.counts: NDArray[np.int64] = coverage([], size_px)
        """(rows, columns): corners in each cell of the picture."""

    @property
    def covered_share(self) -> float:
        """The share of the cells, 0..1, with a corner in any picture."""
        return float(np.mean(self.counts > 0))

    def still(self, motion_px: float) -> bool:
        """Whether the board moves little enough [px per 1/30 s] for a usable picture."""
        return motion_px <= _MOST_MOTION * self.size_px[0]

    def offer(self, view: BoardView, motion_px: float) -> bool:
        """Add this view if it is new; returns whether it was added."""
        if not self.still(motion_px) or self._is_blurred(view):
            return False
        place = rough_place(view, self._board_m, self.size_px)
        if place is None:
            return False
        own = coverage([view], self.size_px)
        new_cells = int(((own > 0) & (self.counts == 0)).sum())
        if len(self.views):
            far = np.linalg.norm(self._places - place, axis=1)
            nearest = int(np.argmin(far))
            if far[nearest] < _NEW_PLACE and new_cells < _NEW_CELLS:
                return False
        if len(self.views) >= _MOST:
            return False
        self.views.append(view)
        self._places = np.vstack([self._places, place])
        self.counts = self.counts + own
        return True

    def lack(self) -> Lack:
        """What to show next."""
        if len(self.views) < _ENOUGH // 2:
            return Lack.PICTURES
        x, y = self._spread()
        if min(x, y) < _SLANT:
            return Lack.SIDEWAYS if x < y else Lack.UPWARDS
        if self.covered_share < _COVERED:
            return Lack.PLACES
        return Lack.NOTHING if len(self.views) >= _ENOUGH else Lack.PICTURES

    def progress(self) -> float:
        """Progress towards enough views, 0..1."""
        x, y = self._spread()
        shares = (
            len(self.views) / _ENOUGH,
            self.covered_share / _COVERED,
            x / _SLANT,
            y / _SLANT,
        )
        return float(np.mean(np.minimum(shares, 1.0)))

    def emptiest(self) -> tuple[int, int]:
        """Row and column (each 0, 1 or 2) of the ninth of the picture with the fewest corners."""
        rows, columns = self.counts.shape
        ninths = np.zeros((3, 3))
        row, column = np.indices((rows, columns))
        np.add.at(ninths, (row * 3 // rows, column * 3 // columns), self.counts > 0)
        at = int(np.argmin(ninths))
        return at // 3, at % 3

    def _is_blurred(self, view: BoardView) -> bool:
        if not self.views:
            return False
        sharp = float(np.percentile([picked.sharpness for picked in self.views], 75))
        return view.sharpness < _LEAST_SHARPNESS * sharp

    def _spread(self) -> tuple[float, float]:
        """Spread of the normals sideways and up and down; about an angle [rad]."""
        if not len(self._places):
            return 0.0, 0.0
        x, y = np.ptp(self._places[:, 3:], axis=0) / _TURN
        return float(x), float(y)


def rough_place(view: BoardView, board_m: Floats, size_px: tuple[int, int]) -> Floats | None:
    """(5,): the board's position in the picture, its size and its slant; None where no pose fits.

    The distance between two measures how alike the views are [picture widths]. Needs no intrinsics: a usual
    focal length is good enough to distinguish slants.
    """
    pose = board_pose(view, board_m, usual_camera_matrix(size_px), np.zeros(5))
    if pose is None:
        return None
    xy = view.corners_px / size_px[0]
    spread = max(float(np.sqrt(xy.var(axis=0).sum())), 1e-6)
    normal = -pose.R[:, 2] if view.back else pose.R[:, 2]  # away from the camera
    return np.array([*xy.mean(axis=0), _SIZE * np.log(spread), *(_TURN * normal[:2])])
