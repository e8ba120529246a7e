"""The room from the wearer alone: poses, body shape and cameras, solved together until all pictures agree."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import N_POSE, N_SHAPE, BodyModel, build_model
from mocapd.body.shape import FACTOR_SD
from mocapd.calibrate.body_rows import (
    N_CAMERA,
    BodyRows,
    RowGatherer,
    camera_columns,
    mean_camera,
    moved_camera,
)
from mocapd.calibrate.keyframes import Keyframe, choose, starts, views
from mocapd.calibrate.patch_tracks import MARKS, Moment, unplaced
from mocapd.calibrate.relative_pose import relative_pose
from mocapd.calibrate.standing import upright
from mocapd.errors import ConfigError
from mocapd.geometry.cameras import centre
from mocapd.trackers.colour.fitting import Fitter, View
from mocapd.trackers.colour.motion_state import MotionState, stepped
from mocapd.trackers.colour.params import Params
from mocapd.types import Camera, Floats, Rig


@dataclass(frozen=True, slots=True)
class RoomParams:
    """How the room is solved."""

    keyframes: int = 48
    rounds: int = 20
    averaged: int = (
        8  # last rounds: steps end in the noise of whole pixels, which their mean halves
    )
    radius_px: int = 14  # work px within which colours are looked for
    polish: int = 3  # iterations of every pose in the room that was found
    loose_s: float = 0.4  # a start is held to as loosely as a prediction over this time
    joint_sd_rad: float = 0.5  # how far a pose may yield to a change of room or shape
    least_match: float = 0.6  # of a keyframe that counts
    tolerated_cost: float = 1.5  # and its cost, against that of the middle one
    least_keyframes: int = 6
    # how many of them count in full against what is known of proportions: their errors are alike
    independent_frames: float = 32.0


@dataclass(frozen=True, slots=True, eq=False)
class RoomReport:
    """How well the room was solved.

    residual_px: RMS by camera, over the drawn shirt, of how far its pixels are from where their
    colour is seen [px of the frames]; frames: keyframes that agree; distance_m: of each camera from
    the first; match: share of the drawn shirt that the pictures confirm; factors (N_SHAPE,): the
    wearer's proportions.
    """

    residual_px: Mapping[str, float]
    frames: int
    distance_m: Mapping[str, float]
    match: float
    factors: Floats


@dataclass(slots=True, eq=False)
class _Scene:
    """What is solved for: cameras, the factors, and a state per keyframe."""

    cameras: list[Camera]
    factors: Floats
    states: list[MotionState]


def room_from_body(
    moments: Sequence[Moment],
    lenses: Sequence[Camera],
    stature_m: float,
    params: RoomParams | None = None,
) -> tuple[Rig, RoomReport]:
    """The rig in world coordinates: floor at y = 0, the wearer at the origin facing +Z at the start.

    moments: from `PatchTracks` of the same cameras. Raises ConfigError when they do not tell where
    the cameras stand.
    """
    p = params if params is not None else RoomParams()
    cameras = first_placing(moments, lenses)
    names = [camera.name for camera in cameras]
    keyframes = choose(moments, names, p.keyframes)
    model = build_model(stature_m)
    solver = RoomSolver(model, cameras, keyframes, p)
    scene, report = solver.solve()
    return upright(Rig(tuple(scene.cameras)), moments, stature_m, scene.factors), report


def first_placing(moments: Sequence[Moment], lenses: Sequence[Camera]) -> list[Camera]:
    """The first camera where a lone webcam would stand, the others by the bodies seen in common.

    Cameras that share nothing with the first are chained through others. Raises ConfigError naming
    a camera that shares nothing with any.
    """
    alone = unplaced(lenses)
    placed: dict[str, Camera] = {alone[0].name: alone[0]}
    while len(placed) < len(alone):
        candidates = [
            (_shared(moments, a, b.name), a, b)
            for a in placed
            for b in alone
            if b.name not in placed
        ]
        shared, known, new = max(candidates, key=lambda one: len(one[0]))
        first = [m[known] for m in shared]
        second = [m[new.name] for m in shared]
        if not shared:
            raise ConfigError(
                "never saw the wearer together with another camera",
                f"camera {new.name!r}",
                "walk where both see the shirt, or turn the camera",
            )
        weights = np.array(
            [
                np.minimum(a.confidence[MARKS], b.confidence[MARKS])
                for a, b in zip(first, second, strict=True)
            ]
        )
        pose = relative_pose(
            np.concatenate([s.joints_m[MARKS] for s in first]),
            np.concatenate([s.joints_m[MARKS] for s in second]),
            weights.ravel(),
        )
        old = placed[known]
        placed[new.name] = replace(new, R=pose.R @ old.R, t_m=pose.R @ old.t_m + pose.t_m)
    return [placed[camera.name] for camera in alone]


def _shared(moments: Sequence[Moment], a: str, b: str) -> list[Moment]:
    return [m for m in moments if a in m and b in m]


class RoomSolver:
    """Gauss-Newton over all cameras but the first, the body's shape, and every keyframe's pose."""

    def __init__(
        self,
        model: BodyModel,
        cameras: Sequence[Camera],
        keyframes: Sequence[Keyframe],
        params: RoomParams,
    ) -> None:
        self._model, self._p = model, params
        self._tracker = Params()
        self._work = [
            max(1, round(c.size_px[0] / self._tracker.work_width_px), -(-max(c.size_px) // 480))
            for c in cameras
        ]
        self._n = N_SHAPE + N_CAMERA * (len(cameras) - 1)
        self._views: list[list[View]] = []
        scene = _Scene(list(cameras), np.ones(N_SHAPE), [])
        fitter = Fitter(model, cameras, self._work, self._tracker)
        for keyframe in keyframes:
            seen = views(keyframe, self._work)
            fits = [
                fitter.fit(s, seen, params.loose_s, 8, learn_shape=False)
                for s in starts(keyframe, cameras, model, scene.factors)
            ]
            best = min(fits, key=lambda fit: fit.cost)
            scene.states.append(best.state)
            self._views.append(seen)
        self.scene = scene

    def solve(self) -> tuple[_Scene, RoomReport]:
        """The scene at rest, and how good it is. Raises ConfigError when too little agrees."""
        p, scene = self._p, self.scene
        kept: list[tuple[tuple[Camera, ...], Floats]] = []
        for i in range(p.rounds):
            self._step(scene, self._gather())
            if i >= p.rounds - p.averaged:
                kept.append((tuple(scene.cameras), scene.factors))
        scene.cameras = [
            mean_camera([cameras[i] for cameras, _ in kept]) for i in range(len(scene.cameras))
        ]
        scene.factors = np.mean([factors for _, factors in kept], axis=0)
        scene.states = [replace(state, factors=scene.factors) for state in scene.states]
        self._polish()
        return scene, self._report(scene, self._gather())

    def _polish(self) -> None:
        """Every pose to rest between the cameras as they are."""
        p, scene = self._p, self.scene
        fitter = Fitter(self._model, scene.cameras, self._work, self._tracker)
        scene.states = [
            fitter.fit(s, v, p.loose_s, p.polish, learn_shape=False).state
            for s, v in zip(scene.states, self._views, strict=True)
        ]

    def _gather(self) -> list[list[BodyRows]]:
        """The rows of every keyframe's views."""
        scene = self.scene
        gatherer = RowGatherer(
            Fitter(self._model, scene.cameras, self._work, self._tracker), self._p.radius_px
        )
        return [
            [gatherer.gather(s, view) for view in v]
            for s, v in zip(scene.states, self._views, strict=True)
        ]

    def _step(self, scene: _Scene, rows: Sequence[Sequence[BodyRows]]) -> None:
        """One step of cameras and shape, the poses following.

        All is moved by the same rows, with the poses eliminated (Schur complement). To alternate with
        the tracker's own fit was tried: its cost differs a little, and room and poses then drift
        together along what the pictures hardly tell.
        """
        p = self._p
        H, b = np.zeros((self._n, self._n)), np.zeros(self._n)
        yields: list[tuple[Floats, Floats] | None] = []
        tolerable = p.tolerated_cost * float(np.median([_cost(frame) for frame in rows]))
        for frame, seen in zip(rows, self._views, strict=True):
            if _match(frame) < p.least_match or _cost(frame) > tolerable:
                yields.append(None)
                continue
            Hpp = np.diag(self._pose_information())
            bp = np.zeros(N_POSE)
            Hps, Hss, bs = (
                np.zeros((N_POSE, self._n)),
                np.zeros((self._n, self._n)),
                np.zeros(self._n),
            )
            for row, view in zip(frame, seen, strict=True):
                J = self._columns(row, view.index)
                Hpp += row.H[:N_POSE, :N_POSE]
                Hps += row.H[:N_POSE] @ J
                Hss += J.T @ row.H @ J
                bs += J.T @ row.b
                bp += row.b[:N_POSE]
            back: Floats = np.asarray(np.linalg.solve(Hpp, Hps), dtype=np.float64)
            own: Floats = np.asarray(np.linalg.solve(Hpp, bp), dtype=np.float64)
            H += Hss - Hps.T @ back
            b += bs - Hps.T @ own
            yields.append((back, own))
        counted = sum(one is not None for one in yields)
        if counted < p.least_keyframes:
            raise ConfigError(
                f"body and pictures agree in {counted} moments only, {p.least_keyframes} are needed",
                "room",
                "check the colours of each camera, then walk about again in the light of now",
            )
        gain = p.independent_frames / counted
        H, b = H * gain, b * gain
        prior = 1.0 / FACTOR_SD**2
        H[:N_SHAPE, :N_SHAPE] += np.diag(prior)
        b[:N_SHAPE] -= prior * (scene.factors - 1.0)
        step: Floats = np.asarray(np.linalg.solve(H + 1e-9 * np.eye(self._n), b), dtype=np.float64)
        scene.factors = np.clip(scene.factors + step[:N_SHAPE], 0.6, 1.6)
        for i in range(1, len(scene.cameras)):
            k = N_SHAPE + N_CAMERA * (i - 1)
            scene.cameras[i] = moved_camera(scene.cameras[i], step[k : k + N_CAMERA])
        for k, (state, follows) in enumerate(zip(scene.states, yields, strict=True)):
            root, local = state.root_m, state.local_xyzw
            if follows is not None:
                root, local = stepped(self._model, root, local, follows[1] - follows[0] @ step)
            scene.states[k] = replace(state, root_m=root, local_xyzw=local, factors=scene.factors)

    def _pose_information(self) -> Floats:
        information = np.full(N_POSE, 1.0 / self._p.joint_sd_rad**2)
        information[:6] = 1e-3  # root and hips are free
        return information

    def _columns(self, row: BodyRows, camera: int) -> Floats:
        """(N_ROW, n): how the row's pose and shape columns make up those of shape and cameras."""
        J = np.zeros((N_POSE + N_SHAPE, self._n))
        J[N_POSE:, :N_SHAPE] = np.eye(N_SHAPE)
        if camera > 0:
            k = N_SHAPE + N_CAMERA * (camera - 1)
            J[:N_CAMERA, k : k + N_CAMERA] = camera_columns(row.at_m).T
        return J

    def _residual_px(self, frames: Sequence[Sequence[BodyRows]], camera: int) -> float:
        mine = [row for frame in frames for row in frame if row.camera == camera]
        visible = sum(float(row.visible.sum()) for row in mine)
        squared = sum(row.cost for row in mine) / self._tracker.row_weight
        return self._work[camera] * float(np.sqrt(squared / max(visible, 1.0)))

    def _report(self, scene: _Scene, rows: Sequence[Sequence[BodyRows]]) -> RoomReport:
        good = [frame for frame in rows if _match(frame) >= self._p.least_match]
        visible = sum(float(r.visible.sum()) for frame in good for r in frame)
        matched = sum(float(r.matched.sum()) for frame in good for r in frame)
        first = centre(scene.cameras[0])
        return RoomReport(
            residual_px={c.name: self._residual_px(good, i) for i, c in enumerate(scene.cameras)},
            frames=len(good),
            distance_m={
                c.name: float(np.linalg.norm(centre(c) - first)) for c in scene.cameras[1:]
            },
            match=matched / max(visible, 1.0),
            factors=scene.factors,
        )


def _cost(frame: Sequence[BodyRows]) -> float:
    """Cost for each drawn pixel of the shirt."""
    return sum(r.cost for r in frame) / max(sum(float(r.visible.sum()) for r in frame), 1.0)


def _match(frame: Sequence[BodyRows]) -> float:
    """Share of the drawn shirt that is confirmed, in the camera that confirms least."""
    return min(row.match for row in frame)
