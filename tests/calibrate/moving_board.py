"""Simulated recordings of a board that somebody waves: corners by camera and frame, with the times told of them.

Each camera has a clock of its own: it begins at another moment, runs at another rate, loses frames with or without
a trace in its stamps.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.board.board_recordings import Recording, RecordingTimes
from mocapd.calibrate.extrinsics.board_sighting import BoardSighting
from mocapd.calibration.board_spec import BoardKind, BoardSpec, corners_m
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project, to_camera
from mocapd.geometry.reprojection import camera_matrix
from mocapd.types import Camera, Floats
from tests.geometry.rigs import looking_at

SPEC = BoardSpec(BoardKind.CHARUCO, 5, 7, 0.075, 0.05625)
BOARD_M = corners_m(SPEC)
_SMALLEST = 8  # corners in one picture


@dataclass(frozen=True)
class Clock:
    """A camera's: frame i is taken at start_s + i / hz. lost: frames that never came; stamped: the file shows it."""

    start_s: float = 0.0
    hz: float = 30.0
    lost: tuple[int, ...] = ()
    stamped: bool = True
    jitter_s: float = 0.0  # of the moments, shown by the stamps


@dataclass(frozen=True)
class Session:
    """Somebody waves the board before a rig for seconds_s, at about speed_mps, at rest for a part of the time."""

    rig: tuple[Camera, ...]
    clocks: Mapping[str, Clock] = field(default_factory=dict)
    seconds_s: float = 7.0
    speed_mps: float = 0.3
    rest: float = 0.0
    noise_px: float = 0.2
    seed: int = 0


def rig_of(cameras: int, width_m: float, hd: bool = False) -> tuple[Camera, ...]:
    """On an arc before the wearer, 2.2 m away."""
    x = np.linspace(-0.5, 0.5, cameras) * width_m
    size_px, focal_px = ((1280, 720), 950.0) if hd else ((640, 480), 560.0)
    target_m = np.array([0.0, 1.15, 0.0])
    out = []
    for i in range(cameras):
        eye_m = np.array([x[i], 1.3 + 0.15 * (i % 2), np.sqrt(max(2.2**2 - x[i] ** 2, 0.5))])
        K = camera_matrix(
            np.array(
                [focal_px + 7.0 * i, focal_px + 7.0 * i, size_px[0] / 2 - 3, size_px[1] / 2 + 4]
            )
        )
        out.append(replace(looking_at(f"cam{i}", eye_m, target_m), size_px=size_px, K=K))
    return tuple(out)


def record(session: Session) -> tuple[list[BoardSighting], dict[str, RecordingTimes]]:
    """What a detector would find in each camera's file, and what the file's stamps would say."""
    rng = np.random.default_rng(session.seed)
    wave = _Wave(session, rng)
    sightings, clocks = [], {}
    for camera in session.rig:
        clock = session.clocks.get(camera.name, Clock())
        count = int(session.seconds_s * clock.hz)
        kept = [i for i in range(count) if i not in clock.lost]
        at_s = np.array(kept) / clock.hz + clock.jitter_s * rng.standard_normal(len(kept))
        shown_s = at_s if clock.stamped else np.arange(len(kept)) / clock.hz
        stamps = shown_s - shown_s[0]
        views: dict[int, BoardView] = {}
        for index, t_s in enumerate(at_s):
            view = _view(camera, *wave.pose(clock.start_s + t_s), index, session.noise_px, rng)
            if view is not None:
                views[index] = view
        recording = Recording(camera.name, Path(camera.name), len(kept), camera.size_px)
        sightings.append(BoardSighting(recording, SPEC, views, len(kept), ()))
        clocks[camera.name] = RecordingTimes(dict(enumerate(stamps.tolist())), 1.0 / clock.hz)
    return sightings, clocks


class _Wave:
    """Smooth motion: a sum of sines, along a time that halts where the board is at rest."""

    def __init__(self, session: Session, rng: np.random.Generator) -> None:
        self._rest = session.rest
        self._beat_s = rng.uniform(1.2, 2.0)
        self._hz = rng.uniform(0.08, 0.9, (6, 6))
        self._phase = rng.uniform(0.0, 2.0 * np.pi, (6, 6))
        size = np.array([0.5, 0.5, 0.4, 0.25, 0.18, 0.2])[:, None] * np.array([1, 1, 1, 1, 1, 1])
        self._size = size * rng.uniform(0.5, 1.0, (6, 6)) / np.sqrt(6)
        t = np.linspace(0.0, session.seconds_s, 400)
        places = np.stack([self._free(u)[3:] for u in t])
        speed = np.linalg.norm(np.diff(places, axis=0), axis=1).mean() / (t[1] - t[0])
        self._pace = session.speed_mps / speed

    def _free(self, t: float) -> Floats:
        out: Floats = (self._size * np.sin(2.0 * np.pi * self._hz * t + self._phase)).sum(axis=1)
        return out

    def pose(self, t_s: float) -> tuple[Floats, Floats]:
        """world_from_board, facing the cameras."""
        beat, part = divmod(t_s / self._beat_s, 1.0)
        moving = max(1.0 - self._rest, 1e-6)
        u = min(part / moving, 1.0)
        smooth = u * u * (3.0 - 2.0 * u) if self._rest else part
        way = self._free(self._pace * (beat + smooth) * self._beat_s)
        facing = np.diag([1.0, -1.0, -1.0])
        R = rotations.to_matrix(rotations.exp(1.6 * way[:3])) @ facing
        middle = BOARD_M.mean(axis=0)
        return R, np.array([0.0, 1.15, 0.1]) + 1.3 * way[3:] - R @ middle


def _view(
    camera: Camera,
    R: Floats,
    t_m: Floats,
    index: int,
    noise_px: float,
    rng: np.random.Generator,
) -> BoardView | None:
    world_m = BOARD_M @ R.T + t_m
    away = to_camera(camera, world_m).mean(axis=0)
    if float(away @ (camera.R @ R[:, 2])) / np.linalg.norm(away) < 0.3:
        return None  # seen too much from the side
    px = project(camera, world_m) + noise_px * rng.standard_normal((len(world_m), 2))
    inside = ((px > 2.0) & (px < np.array(camera.size_px) - 3.0)).all(axis=1)
    if inside.sum() < _SMALLEST:
        return None
    return BoardView(index, np.flatnonzero(inside), px[inside], 0.4)


def errors(rig: tuple[Camera, ...], found: tuple[Camera, ...]) -> tuple[float, float]:
    """[cm], [deg]: of the worst camera, seen from the first."""
    cm, deg = [0.0], [0.0]
    for true, camera in zip(rig[1:], found[1:], strict=True):
        centres, turns = [], []
        for one, first in ((true, rig[0]), (camera, found[0])):
            turn = one.R @ first.R.T
            centres.append(-turn.T @ (one.t_m - turn @ first.t_m))
            turns.append(turn)
        cm.append(100.0 * float(np.linalg.norm(centres[0] - centres[1])))
        cosine = (np.trace(turns[0] @ turns[1].T) - 1.0) / 2.0
        deg.append(float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0)))))
    return max(cm), max(deg)
