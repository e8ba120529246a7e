"""Sightings of the board collected for the extrinsics: whether they are enough, and who shares none."""

from collections.abc import Sequence

import numpy as np

from mocapd.calibrate.board.board_look import BoardObservation, Look
from mocapd.calibrate.board.board_sightings import BoardSightings, Views
from mocapd.calibrate.extrinsics.pose_graph import FEWEST_SHARED
from mocapd.calibration.board_spec import BoardSpec, corners_m
from mocapd.wizard.draft import DraftCamera

ENOUGH = 10  # sightings in all
_OWN = 5  # of them in this step: those of the step Lens were held near one camera
_SHARED = 4  # of each camera with the others
_MORE = 3  # sightings before another try


class BoardCollection:
    """What was seen of the board, with that of the step Lens to begin with."""

    def __init__(self, cameras: Sequence[DraftCamera], spec: BoardSpec, earlier: Views) -> None:
        self._cameras = tuple(cameras)
        self._sightings = BoardSightings(
            {camera.id: camera.size_px for camera in cameras}, corners_m(spec)
        )
        self._sightings.add(earlier)
        self._own = 0  # sightings of this step
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
        return self._sightings.linked(FEWEST_SHARED)

    @property
    def due(self) -> bool:
        """Whether there are enough, and more than at the last try."""
        enough = (
            self._own >= _OWN
            and self._sightings.count >= ENOUGH
            and self._sightings.linked(_SHARED)
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

    def apart(self) -> list[DraftCamera]:
        """Cameras that do not yet hang together with most others."""
        together = self._sightings.largest_group(_SHARED)
        return [camera for camera in self._cameras if camera.id not in together]

    def lonely(self) -> list[DraftCamera]:
        """Cameras that share no sighting with any other."""
        return [
            camera
            for camera in self._cameras
            if not any(
                self._sightings.shared(camera.id, other.id)
                for other in self._cameras
                if other.id != camera.id
            )
        ]

    def shared(self, a: DraftCamera, b: DraftCamera) -> int:
        """How many sightings two cameras share."""
        return self._sightings.shared(a.id, b.id)
