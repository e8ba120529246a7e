"""Collects sightings of the board live for the extrinsics, and decides whether they suffice."""

from collections.abc import Mapping

import numpy as np

from mocapd.calibrate.board.board_instant import BoardInstant
from mocapd.calibrate.board.board_sightings import BoardSightings, Views
from mocapd.calibrate.extrinsics.pose_graph import FEWEST_SHARED
from mocapd.calibration.board_spec import BoardSpec, corners_m

ENOUGH = 10  # sightings in all
_OWN = 5  # of them new: those of the intrinsics are near one camera
_SHARED = 4  # of each camera with the others
_MORE = 3  # sightings before another attempt


class BoardCollection(BoardSightings):
    """The sightings of the board, starting with those of the intrinsics, and whether they suffice."""

    def __init__(
        self, sizes_px: Mapping[str, tuple[int, int]], spec: BoardSpec, earlier: Views
    ) -> None:
        """sizes_px: width and height of the pictures by camera."""
        super().__init__(sizes_px, corners_m(spec))
        self.add(earlier)
        self._cameras = tuple(sizes_px)
        self._own = 0  # new sightings
        self._tried = 0  # of them at the last try

    @property
    def solvable(self) -> bool:
        """Whether a solution is possible."""
        return self.all_connected(FEWEST_SHARED)

    @property
    def due(self) -> bool:
        """Whether there are enough, and more than at the last attempt."""
        enough = self._own >= _OWN and self.count >= ENOUGH and self.all_connected(_SHARED)
        return enough and (not self._tried or self._own >= self._tried + _MORE)

    @property
    def progress(self) -> float:
        """Progress towards enough sightings, 0..1."""
        shares = (
            self._own / _OWN,
            self.count / ENOUGH,
            len(self.largest_group(_SHARED)) / len(self._cameras),
        )
        return float(np.mean(np.minimum(shares, 1.0)))

    def offer(self, instant: BoardInstant) -> bool:
        """See BoardSightings; counts the new sightings."""
        is_new = super().offer(instant)
        self._own += is_new
        return is_new

    def try_now(self) -> None:
        """Record an attempt with these: the next one needs more."""
        self._tried = self._own

    def apart(self) -> list[str]:
        """Cameras outside the largest group that common sightings connect."""
        together = self.largest_group(_SHARED)
        return [name for name in self._cameras if name not in together]

    def lonely(self) -> list[str]:
        """Cameras without a sighting in common with any other."""
        return [
            name
            for name in self._cameras
            if not any(self.common_count(name, other) for other in self._cameras if other != name)
        ]
