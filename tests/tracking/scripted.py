"""Cues that find what a script says, of a person who walks about and swings the arms."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np

from mocapd.body.areas import N_AREAS
from mocapd.body.model import BodyModel, build_model
from mocapd.body.pose_space import full_body
from mocapd.body.shape import mean_shape, skeleton_of
from mocapd.body.skeleton import INDEX, N_JOINTS, global_from_local, joint_positions, rest_pose
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_params import FitParams
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.solver import Fitter
from mocapd.geometry import rotations
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.shirt.garment import shirt_labels
from mocapd.tracking.base import LostReason, Track
from mocapd.tracking.body_tracker import BodyTracker
from mocapd.tracking.cues.clothes.clothes_cue import ClothesCue
from mocapd.tracking.cues.clothes.clothes_solver import ClothesEstimate, ClothesObservation
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue, ShirtEstimate
from mocapd.tracking.cues.shirt.shirt_params import ShirtParams
from mocapd.tracking.track_state import BodyShapeEstimate, TrackState, upper_body_state
from mocapd.tracking.trunk_and_legs import join_bodies
from mocapd.types import BodyState, Floats, Frame, FrameSet, Pose, Rig

STATURE_M = 1.7
SHAPE = mean_shape(STATURE_M)
SKELETON = skeleton_of(SHAPE)
WHOLE, UPPER = build_model(STATURE_M, full_body()), build_model(STATURE_M)
NEAR_M = 0.5  # a cue finds a body no farther from where it looks
RIG = Rig(
    tuple(replace(nominal_rig("cam0", (32, 24)).cameras[0], name=f"cam{i}") for i in range(3))
)
_BLACK = np.zeros((24, 32, 3), np.uint8)
_PATCH_PX = 500.0


@dataclass(frozen=True)
class Sight:
    """What a cue sees from then on. quality: None for nothing; off_m: away from where the person is, along x; arms_rad:
    raised beyond the true pose; knees_rad: bent beyond it."""

    from_s: float
    quality: float | None = 0.8
    off_m: float = 0.0
    arms_rad: float = 0.0
    knees_rad: float = 0.0


ALWAYS = (Sight(0.0),)
NEVER = (Sight(0.0, None),)


def true_local(t_ns: int) -> tuple[Floats, Floats]:
    """Root (3,) and local rotations (J,4) of somebody who walks at half a metre per second and swings arms and knees."""
    t_s = seconds(t_ns)
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    for joint, axis, width in (
        ("leftLowerArm", 1, 0.5), ("rightLowerArm", 1, 0.4), ("leftLowerLeg", 0, 0.3), ("neck", 1, 0.3),
    ):  # fmt: skip
        turn = np.zeros(3)
        turn[axis] = width * np.sin(3.0 * t_s)
        local[INDEX[joint]] = rotations.exp(turn)
    return rest_pose(SKELETON).root_m + (0.5 * np.sin(t_s), 0.0, 0.0), local


def true_joints_m(t_ns: int) -> Floats:
    root_m, local = true_local(t_ns)
    return joint_positions(SKELETON, Pose(root_m, global_from_local(SKELETON, local)))


def _motion(t_ns: int, sight: Sight) -> MotionState:
    root_m, local = true_local(t_ns)
    for side, way in (("left", 1.0), ("right", -1.0)):
        raised = rotations.exp(np.array([0.0, 0.0, way * sight.arms_rad]))
        local[INDEX[side + "UpperArm"]] = raised
        bent = rotations.exp(np.array([sight.knees_rad, 0.0, 0.0]))
        knee = INDEX[side + "LowerLeg"]
        local[knee] = rotations.multiply(bent, local[knee])
    return MotionState(
        root_m + (sight.off_m, 0.0, 0.0), local, np.zeros(WHOLE.n_pose), np.ones(WHOLE.n_shape),
        initial_information(WHOLE.space),
    )  # fmt: skip


def _fit(model: BodyModel, motion: MotionState, quality: float) -> Fit:
    """Of pictures that confirm this share of each patch."""
    n = model.n_pose + model.n_shape
    drawn = np.full(N_AREAS, _PATCH_PX)
    information = 1e5 * np.eye(model.n_pose)
    return Fit(motion, drawn, quality * drawn, np.zeros(N_AREAS), 1e5 * np.eye(n), 0.0, information)


class _Scripted:
    """Goes by time alone."""

    def __init__(self, script: Sequence[Sight], model: BodyModel) -> None:
        self.script, self.model = script, model
        self.fitter = Fitter(model, shirt_labels(model), (), [], FitParams())
        self.frames = FrameSet(0, {})  # those of the present step

    def reset(self) -> None:
        pass

    def rehearse(self) -> None:
        pass

    def take(self, *_: object) -> None:
        pass

    @property
    def present(self) -> dict[int, float]:
        return dict.fromkeys(range(len(self.frames.frames)), 0.0)

    @property
    def sight(self) -> Sight:
        return next(s for s in reversed(self.script) if nanoseconds(s.from_s) <= self.frames.t_ns)

    def found_near(self, near: MotionState | None) -> MotionState | None:
        """What is seen now, if that is where it is looked for; None for anywhere."""
        if self.sight.quality is None or not self.present:
            return None
        motion = _motion(self.frames.t_ns, self.sight)
        if near is not None and np.linalg.norm(motion.root_m - near.root_m) > NEAR_M:
            return None
        return motion


class ScriptedShirt(_Scripted):
    """Stands in for `ShirtCue`. looked_ns: when it was asked about a body that clothes carry."""

    def __init__(self, script: Sequence[Sight]) -> None:
        super().__init__(script, UPPER)
        self.params = ShirtParams()
        self.segmenters = SimpleNamespace()
        self.looked_ns: list[int] = []

    def _as_shirt(self, motion: MotionState | None) -> ShirtEstimate | None:
        if motion is None or self.sight.quality is None:
            return None
        upper = upper_body_state(motion, UPPER)
        return ShirtEstimate(_fit(UPPER, upper, self.sight.quality), upper, (), 0.0)

    def follow(self, known: TrackState, predicted: MotionState, *_: object) -> ShirtEstimate | None:
        return self._as_shirt(self.found_near(predicted))

    def start_from(self, body: MotionState, *_: object) -> ShirtEstimate | None:
        self.looked_ns.append(self.frames.t_ns)
        return self._as_shirt(self.found_near(body))

    def is_search_due(self, _: int) -> bool:
        return True

    def search(
        self,
        _w: BodyShapeEstimate,
        _p: dict[int, float],
        _t: int,
        _pause: float,
        better_than: float,
        _frame_index: int,
    ) -> ShirtEstimate | None:
        found = self._as_shirt(self.found_near(None))
        return found if found is not None and found.fit.match > better_than else None

    def evidence(self, _: object) -> tuple[dict[str, Any], dict[str, Any]]:
        return {}, {}

    def names(self, _: object) -> tuple[str, ...]:
        return tuple(self.frames.frames)

    def learn(self, *_: object) -> None:
        pass


class ScriptedClothes(_Scripted):
    """Stands in for `ClothesCue`."""

    def __init__(
        self, script: Sequence[Sight], lost_reason: LostReason | None = None, alone: bool = True
    ) -> None:
        super().__init__(script, WHOLE)
        self.alone, self.rests_below_the_shirt, self.legs_rest = alone, False, False
        self.nobody = SimpleNamespace(body=np.zeros((1, 1), np.uint8))
        self._lost_reason = lost_reason

    @property
    def cameras(self) -> SimpleNamespace:
        return SimpleNamespace(
            present=self.present, each=[self.nobody] * 3, evidence=lambda _: ({}, {})
        )

    def _as_clothes(self, motion: MotionState | None) -> ClothesEstimate | None:
        if motion is None or self.sight.quality is None:
            return None
        return ClothesEstimate(
            _fit(WHOLE, motion, self.sight.quality), motion, (), tuple(self.frames.frames)
        )

    def observe(
        self, predicted: MotionState, _t_ns: int, _since_ns: int | None, shirt_carries: bool
    ) -> ClothesObservation | None:
        self.legs_rest = self.rests_below_the_shirt and shirt_carries
        return None if self.legs_rest else ClothesObservation(predicted, [], ())

    def fit_whole_body(
        self, known: TrackState, seen: ClothesObservation, *_: object
    ) -> ClothesEstimate | None:
        return self._as_clothes(self.found_near(seen.drawn))

    def fit_lower_body(
        self, known: TrackState, start: MotionState, *_: object
    ) -> ClothesEstimate | None:
        seen = self.found_near(start)
        return self._as_clothes(
            None if seen is None else join_bodies(seen, upper_body_state(start, UPPER))
        )

    def search(self, _: BodyShapeEstimate, _t_ns: int) -> ClothesEstimate | None:
        return self._as_clothes(self.found_near(None))

    def start_from(self, there: MotionState) -> ClothesEstimate | None:
        return self._as_clothes(self.found_near(there))

    def lost_reason(self, _: int) -> LostReason | None:
        return self._lost_reason

    def detect_keypoints(self, *_: object) -> None:
        pass

    def learn(self, *_: object) -> None:
        pass


@dataclass
class Scene:
    """A body tracker over scripted cues."""

    shirt: ScriptedShirt | None
    clothes: ScriptedClothes | None
    tracker: BodyTracker

    def step(self, frames: FrameSet) -> Track:
        for cue in (self.shirt, self.clothes):
            if cue is not None:
                cue.frames = frames
        return self.tracker.step(frames, SHAPE)

    def run(
        self,
        until_s: float,
        cameras: Callable[[float], int] = lambda _: 2,
        hz: float = 30.0,
        from_s: float = 0.0,
    ) -> list[BodyState]:
        """What is published."""
        return [
            self.step(frame_set(round(k * 1e9 / hz), cameras(k / hz))).body
            for k in range(round(from_s * hz), round(until_s * hz))
        ]


def frame_set(t_ns: int, cameras: int) -> FrameSet:
    """Frames of so many cameras."""
    return FrameSet(t_ns, {f"cam{i}": Frame(f"cam{i}", 0, t_ns, _BLACK) for i in range(cameras)})


def scene(
    shirt: Sequence[Sight] | None,
    clothes: Sequence[Sight] | None,
    lost_reason: LostReason | None = None,
    alone: bool = True,
) -> Scene:
    """The cues from their scripts; None for a tracker without it. alone: clothes place a whole body, too."""
    one = ScriptedShirt(shirt) if shirt is not None else None
    other = ScriptedClothes(clothes, lost_reason, alone) if clothes is not None else None
    tracker = BodyTracker(
        "auto", RIG, STATURE_M, cast("ShirtCue | None", one), cast("ClothesCue | None", other)
    )
    return Scene(one, other, tracker)


def at(bodies: Sequence[BodyState], t_s: float) -> BodyState:
    """The first published at that time or later."""
    return next(body for body in bodies if body.t_ns >= nanoseconds(t_s) - 1000)


def joints_of(body: BodyState) -> Floats:
    """Of somebody who is not lost."""
    assert body.joints_m is not None
    return body.joints_m
