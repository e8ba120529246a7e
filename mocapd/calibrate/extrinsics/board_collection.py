"""Collects sightings of the board live for the extrinsics, and decides whether they suffice."""

from collections.abc import Mapping

import numpy as np

from mocapd.calibrate.board.board_instant import BoardInstant, BoardObservation
from mocapd.calibrate.board.board_sightings import BoardSightings, Views
from mocapd.calibrate.extrinsics.pose_graph import FEWEST_SHARED
from mocapd.calibration.board_spec import BoardSpec, corners_m

ENOUGH = 10  # sightings in all
_OWN = 5  # of them new: those of the intrinsics are near one camera
_SHARED = 4  # of each camera with the others
_MORE = 3  # sightings before another attempt


class BoardCollection:
    """The views of the board by camera and sighting, starting with those of the intrinsics."""

    def __init__(
        self, sizes_px: Mapping[str, tuple[int, int]], spec: BoardSpec, earlier: Views
    ) -> None:
        """sizes_px: width and height of the pictures by camera."""
        self._cameras = tuple(sizes_px)
        self._sightings = BoardSightings(sizes_px, corners_m(spec))
        self._sightings.add(earlier)
        self._own = 0  # new sightings
        self._tried = 0  # of them at the last try

    @property
    def views(self) -> Views:
        """By camera and index."""
        return self._sightings.views

    @property
    def count(self) -> int:
        """Sightings by two cameras or more."""
        return self._sightings.count

    @property
    def solvable(self) -> bool:
        """Whether a solution is possible."""
        return self._sightings.all_connected(FEWEST_SHARED)

    @property
    def due(self) -> bool:
        """Whether there are enough, and more than at the last attempt."""
        enough = (
            self._own >= _OWN
            and self._sightings.count >= ENOUGH
            and self._sightings.all_connected(_SHARED)
        )
        return enough and (not self._tried or self._own >= self._tried + _MORE)

    @property
    def progress(self) -> float:
        """Progress towards enough sightings, 0..1."""
        shares = (
            self._own / _OWN,
            self._sightings.count / ENOUGH,
            len(self._sightings.largest_group(_SHARED)) / len(self._cameras),
        )
        return float(np.mean(np.minimum(shares, 1.0)))

    def offer(self, instant: BoardInstant) -> None:
        """Add an instant."""
        self._own += self._sightings.offer(instant)

    def try_now(self) -> None:
        """Record an attempt with these: the next one needs more."""
        self._tried = self._own

    def still(self, name: str, observation: BoardObservation) -> bool:
        """Whether the board is at rest in this camera."""
        return self._sightings.still(name, observation)

    def still_px(self) -> dict[str, float]:
        """By camera the largest motion of a board at rest [px per 1/30 s]."""
        return self._sightings.still_px()

    def apart(self) -> list[str]:
        """Cameras outside the largest group that common sightings connect."""
        together = self._sightings.largest_group(_SHARED)
        return [name for name in self._cameras if name not in together]

    def lonely(self) -> list[str]:
        """Cameras without a sighting in common with any other."""
        return [
            name
            for name in self._cameras
            if not any(self.common_count(name, other) for other in self._cameras if other != name)
        ]

    def common_count(self, a: str, b: str) -> int:
        """The number of common sightings of two cameras."""
        return self._sightings.common_count(a, b)
