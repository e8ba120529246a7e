"""Sightings of the board, collected live for the extrinsics: whether they suffice, and which cameras share none."""

from collections.abc import Mapping

import numpy as np

from mocapd.calibrate.board.board_look import BoardObservation, Look
from mocapd.calibrate.board.board_sightings import BoardSightings, Views
from mocapd.calibrate.extrinsics.pose_graph import FEWEST_SHARED
from mocapd.calibration.board_spec import BoardSpec, corners_m

ENOUGH = 10  # sightings in all
_OWN = 5  # of them new: for the intrinsics the board was held near one camera
_SHARED = 4  # of each camera with the others
_MORE = 3  # sightings before another try


class BoardCollection:
    """The views of the board by camera and sighting; it begins with those that the intrinsics were measured from."""

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
        """Sightings that two cameras or more share."""
        return self._sightings.count

    @property
    def solvable(self) -> bool:
        """Whether there is anything to solve from."""
        return self._sightings.all_connected(FEWEST_SHARED)

    @property
    def due(self) -> bool:
        """Whether there are enough, and more than at the last try."""
        enough = (
            self._own >= _OWN
            and self._sightings.count >= ENOUGH
            and self._sightings.all_connected(_SHARED)
        )
        return enough and (not self._tried or self._own >= self._tried + _MORE)

    @property
    def progress(self) -> float:
        """0..1, how much of what is enough there is."""
        shares = (
            self._own / _OWN,
            self._sightings.count / ENOUGH,
            len(self._sightings.largest_group(_SHARED)) / len(self._cameras),
        )
        return float(np.mean(np.minimum(shares, 1.0)))

    def offer(self, look: Look) -> None:
        """A further look at the board."""
        self._own += self._sightings.offer(look)

    def try_now(self) -> None:
        """It is solved from these: the next try needs more."""
        self._tried = self._own

    def still(self, name: str, seen: BoardObservation) -> bool:
        """Whether the board is at rest in this camera."""
        return self._sightings.still(name, seen)

    def still_px(self) -> dict[str, float]:
        """By camera the motion [px per 1/30 s] under which the board is at rest."""
        return self._sightings.still_px()

    def apart(self) -> list[str]:
        """Cameras outside of the largest group that shared sightings link."""
        together = self._sightings.largest_group(_SHARED)
        return [name for name in self._cameras if name not in together]

    def lonely(self) -> list[str]:
        """Cameras that share no sighting with any other."""
        return [
            name
            for name in self._cameras
            if not any(self.common_count(name, other) for other in self._cameras if other != name)
        ]

    def common_count(self, a: str, b: str) -> int:
        """How many sightings two cameras share."""
        return self._sightings.common_count(a, b)
