"""Detects a board at rest, and averages its corners over pictures."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.board.board_instant import BoardInstant, BoardObservation, shift_px
from mocapd.calibrate.extrinsics.board_extrinsics import SceneExtrinsics, with_board
from mocapd.calibrate.extrinsics.world_frame import camera_centres
from mocapd.calibration.board_spec import centre_m
from mocapd.types import Floats

LONG_NS = 1_500_000_000  # after so long at rest the user has laid it down
_SAME_PX = 2.0  # corners that move less are of the board at rest
_FEWEST = 3  # instants to average
_LEVEL_RAD = 0.9  # from the up direction estimated from the cameras, which look down
_ROLL_RAD = 0.26  # of a camera about its axis: they stand upright on shelves and tripods
_UNDER_M = 0.1  # the floor is at least this far below the earlier places of the board
_ABOVE_M = 0.2  # the lowest camera is at least this far above the floor


class BoardAtRest:
    """Collects instants for as long as the board does not move."""

    def __init__(self) -> None:
        self._instants: list[BoardInstant] = []
        self._observations: dict[str, list[BoardObservation]] = {}

    @property
    def since_ns(self) -> int:
        """Duration at rest [ns]."""
        return self._instants[-1].t_ns - self._instants[0].t_ns if self._instants else 0

    @property
    def has_enough(self) -> bool:
        """Whether enough instants show the board at rest."""
        return len(self._instants) >= _FEWEST

    def take(self, instant: BoardInstant, still: Mapping[str, bool]) -> None:
        """Add an instant; `still[camera]`: whether the board is at rest in that camera."""
        at_rest = {name: now for name, now in instant.observations.items() if still[name]}
        if not at_rest:
            self.forget()
            return
        if any(self._has_moved(name, now) for name, now in at_rest.items()):
            self.forget()
        self._instants.append(instant)
        for name, now in at_rest.items():
            self._observations.setdefault(name, []).append(now)

    def forget(self) -> None:
        """Start over after a movement."""
        self._instants, self._observations = [], {}

    def views(self) -> dict[str, BoardView]:
        """By camera the mean of its corners, under the index of the newest instant."""
        index = self._instants[-1].index
        return {
            name: _mean([observation.view for observation in own], index)
            for name, own in self._observations.items()
        }

    def _has_moved(self, name: str, observation: BoardObservation) -> bool:
        before = self._observations.get(name)
        return before is not None and shift_px(before[0].view, observation.view) > _SAME_PX


def _mean(views: list[BoardView], index: int) -> BoardView:
    ids, counts = np.unique(np.concatenate([view.ids for view in views]), return_counts=True)
    ids = ids[2 * counts >= len(views)]
    rows = [
        np.stack([view.corners_px[view.ids == corner][0] for view in views if corner in view.ids])
        for corner in ids
    ]
    corners_px = np.stack([row.mean(axis=0) for row in rows])
    return replace(views[-1], index=index, ids=ids, corners_px=corners_px)


def looks_like_floor(extrinsics: SceneExtrinsics, views: Mapping[str, BoardView]) -> bool:
    """Whether a board at rest lies on the floor, face up: level relative to the cameras, below all earlier places."""
    return _lies(extrinsics, views, face_up=True)


def lies_on_its_face(extrinsics: SceneExtrinsics, views: Mapping[str, BoardView]) -> bool:
    """Whether a two-sided board seems to lie on the floor with its back up."""
    return extrinsics.spec.two_sided and _lies(extrinsics, views, face_up=False)


def _lies(extrinsics: SceneExtrinsics, views: Mapping[str, BoardView], face_up: bool) -> bool:
    scene = extrinsics.bundle.scene
    lying = with_board(extrinsics, -1, views).bundle.scene
    scene_from_board, camera_axes = lying.scene_from_board[-1], scene.camera_from_scene.R
    up = scene_from_board.R[:, 2] * (-1.0 if face_up else 1.0)
    cameras_up = -camera_axes[:, 1].sum(axis=0)
    level = float(up @ cameras_up) / float(np.linalg.norm(cameras_up)) > np.cos(_LEVEL_RAD)
    rolls = np.abs(np.arcsin(np.clip(camera_axes[:, 0] @ up, -1.0, 1.0)))
    height_m = float(scene_from_board.apply(centre_m(extrinsics.spec)) @ up)
    above = float((camera_centres(scene) @ up).min()) - height_m > _ABOVE_M
    return bool(
        level and np.median(rolls) < _ROLL_RAD and above and height_m < _lowest_m(extrinsics, up)
    )


def _lowest_m(extrinsics: SceneExtrinsics, up: Floats) -> float:
    """A height [m] below almost all places of the board in the user's hands."""
    if not extrinsics.indices:
        return float("inf")
    middles = extrinsics.bundle.scene.scene_from_board.apply(centre_m(extrinsics.spec))
    # a percentile, since some poses may be wrong
    return float(np.percentile(middles @ up, 20)) - _UNDER_M
