"""One camera in the step Lens: its pictures of the board, its intrinsics, and its messages."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics, solve_intrinsics
from mocapd.calibrate.intrinsics.view_picking import Lack, PickedViews
from mocapd.calibrate.intrinsics.views import GRID, choose_views
from mocapd.errors import MocapdError, Problem
from mocapd.types import Floats
from mocapd.wizard.draft import DraftCamera
from mocapd.wizard.step import Json, Shape

_MOST = 24  # pictures in a solution
_FIRST_TRY = 10  # pictures, even if they lack something: the error then says what
_NEXT_TRY = 4  # more pictures
_ROWS = ("upper", "middle", "lower")
_COLUMNS = ("left", "middle", "right")
# for ending the collection automatically
_HELD_OUT = 1.0 / 640  # error, in parts of the picture's width
_FOCAL_DEVIATION = 0.005  # of the focal length, relative
_COVERED = 0.5
_PATIENCE = 24  # pictures, after which twice the deviation is acceptable
_BY_HAND = 0.02  # deviation of the focal length at which the user may end it


@dataclass(frozen=True, slots=True, eq=False)
class IntrinsicsOffer:
    """Earlier intrinsics. when: day of measurement, "" in this setup; from_file: of another setup."""

    intrinsics: Intrinsics
    when: str
    from_file: bool


@dataclass(slots=True, eq=False)
class CameraIntrinsics:
    camera: DraftCamera
    picked: PickedViews
    offered: IntrinsicsOffer | None = None
    taken: IntrinsicsOffer | None = None  # the offer, if the user accepted it
    intrinsics: Intrinsics | None = None  # the result of the step
    usable: Intrinsics | None = None  # the newest solution below the goal
    refusal: Problem | None = None
    tried: int = 0  # pictures at the last attempt

    @property
    def name(self) -> str:
        """The user's name for it."""
        return self.camera.label or self.camera.id

    def due(self) -> bool:
        """Whether there are enough new pictures for an attempt."""
        count = len(self.picked.views)
        if self.intrinsics is not None:
            return False
        return count >= (self.tried + _NEXT_TRY if self.tried else _FIRST_TRY)

    def solve(self, views: Sequence[BoardView], board_m: Floats) -> Intrinsics:
        """For a job. Raises ConfigError that names the problem of the pictures."""
        chosen = choose_views(views, self.camera.size_px, _MOST)
        return solve_intrinsics(chosen, board_m, self.camera.size_px, self.name)

    def take(self, intrinsics: Intrinsics, tried: int) -> None:
        """Take the job's intrinsics: the result if good enough, or the best so far."""
        self.tried, self.refusal, self.usable = tried, None, intrinsics
        deviation = _FOCAL_DEVIATION * (2.0 if tried >= _PATIENCE else 1.0)
        if (
            intrinsics.held_out_px <= _HELD_OUT * self.camera.size_px[0]
            and intrinsics.focal_deviation <= deviation
            and self.picked.covered_share >= _COVERED
        ):
            self.intrinsics = intrinsics

    def refuse(self, error: MocapdError, tried: int) -> None:
        self.tried, self.refusal = tried, Problem.of(error)

    def use(self, offered: IntrinsicsOffer | None) -> None:
        """Use earlier intrinsics; None: measure new ones."""
        self.taken = offered
        self.intrinsics = None if offered is None else offered.intrinsics
        self.refusal = None

    def by_hand(self) -> Intrinsics | None:
        """The intrinsics that the user may accept now."""
        if self.intrinsics is not None:
            return self.intrinsics
        if self.usable is not None and self.usable.focal_deviation <= _BY_HAND:
            return self.usable
        return None

    def progress(self) -> float:
        return 1.0 if self.intrinsics is not None else 0.95 * self.picked.progress()

    def sentence(self) -> str:
        """The next instruction for this camera."""
        lack = self.picked.lack()
        if lack is Lack.SIDEWAYS:
            return f"{self.name}: turn the board's left or right edge towards the camera."
        if lack is Lack.UPWARDS:
            return f"{self.name}: tilt the board's upper or lower edge towards the camera."
        if lack is Lack.PLACES:
            row, column = self.picked.emptiest()
            where = f"{_ROWS[row]} {_COLUMNS[column]}".replace("middle middle", "middle")
            return f"{self.name}: hold the board in the {where} of the picture."
        if self.usable is not None and self.picked.covered_share >= _COVERED:
            return f"{self.name}: show the board nearer, and tilted more."
        return (
            f"Show the board to {self.name}: here and there, tilted, still for a moment each time."
        )

    def cells(self) -> Iterator[Shape]:
        """The coverage map over the picture."""
        width, height = self.camera.size_px
        across, down = width / GRID[0], height / GRID[1]
        for row, column in np.argwhere(self.picked.counts).tolist():
            count = int(self.picked.counts[row, column])
            x, y = column * across - 0.5, row * down - 0.5
            at = ((x, y), (x + across, y), (x + across, y + down), (x, y + down))
            level = 1 + (count > 2) + (count > 5)
            yield Shape("polygon", at, f"cell-{level}")

    def details(self) -> dict[str, Json]:
        return {
            "name": self.name,
            "views": len(self.picked.views),
            "covered": round(self.picked.covered_share, 3),
            "lens": _figures(self.intrinsics) if self.intrinsics is not None else None,
            "so_far": _figures(self.usable) if self.usable is not None else None,
            "taken": self.taken is not None,
            "offered": None if self.offered is None else {"when": self.offered.when},
        }


def _figures(intrinsics: Intrinsics) -> dict[str, Json]:
    return {
        "rms_px": _round(intrinsics.rms_px, 3),
        "held_out_px": _round(intrinsics.held_out_px, 3),
        "focal_percent": _round(100.0 * intrinsics.focal_deviation, 2),
    }


def _round(value: float, digits: int) -> float | None:
    """None for NaN, which JSON has not."""
    return round(float(value), digits) if value == value else None
