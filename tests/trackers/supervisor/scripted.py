"""Trackers that say what a script tells them, of a person who walks about and swings the arms."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.body.shape import BodyShape, mean_shape, skeleton_of
from mocapd.body.skeleton import INDEX, N_JOINTS, joint_positions, rest_pose
from mocapd.clock import nanoseconds, seconds
from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.trackers.base import Probe, Track, lost_body, unprobed
from mocapd.trackers.lost_reason import LostReason
from mocapd.trackers.supervisor.kinds import KINDS
from mocapd.trackers.supervisor.params import Params
from mocapd.trackers.supervisor.supervisor import Candidate, Supervisor
from mocapd.types import BodyState, Floats, Frame, FrameSet, Pose, Tracking

SHAPE = mean_shape(1.7)
PERIOD_NS = 33_333_333
_PIXEL = np.zeros((1, 1, 3), np.uint8)


@dataclass(frozen=True)
class Word:
    """What is said from then on. off_m: away from where the person is, along x; arms_rad: raised beyond
    the true pose; knees_rad: bent beyond it; lost_reason: of who is lost."""

    from_s: float
    tracking: Tracking = Tracking.LIVE
    quality: float = 0.8
    off_m: float = 0.0
    arms_rad: float = 0.0
    knees_rad: float = 0.0
    lost_reason: LostReason | None = None


LOST = Tracking.LOST


def true_pose(t_ns: int) -> Pose:
    """Somebody walks at half a metre per second and swings arms and knees."""
    t_s = seconds(t_ns)
    rest = rest_pose(skeleton_of(SHAPE))
    quats = rest.quats_xyzw.copy()
    for joint, axis, width in (
        ("leftLowerArm", 1, 0.5), ("rightLowerArm", 1, 0.4), ("leftLowerLeg", 0, 0.3), ("neck", 1, 0.3),
    ):  # fmt: skip
        turn = np.zeros(3)
        turn[axis] = width * np.sin(3.0 * t_s)
        quats[INDEX[joint]] = rotations.exp(turn)
    return Pose(rest.root_m + (0.5 * np.sin(t_s), 0.0, 0.0), quats)


class ScriptedTracker:
    """Goes by time alone. Remembers at which times it was stepped, and guided, and what it was offered."""

    def __init__(self, name: str, script: Sequence[Word], confidence: float) -> None:
        self.name = name
        self.probe: Probe = unprobed
        self.script, self._confidence = script, confidence
        self.stepped_ns: list[int] = []
        self.guided_by: dict[int, BodyState] = {}
        self.offers: list[BodyState | None] = []
        self.shapes: list[BodyShape] = []

    def reset(self, near: BodyState | None = None) -> None:
        self.offers.append(near)

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        self.stepped_ns.append(frames.t_ns)
        self.shapes.append(shape)
        self.probe("look")
        word = next(w for w in reversed(self.script) if nanoseconds(w.from_s) <= frames.t_ns)
        if word.tracking is LOST:
            lost = lost_body(frames.t_ns, self.name)
            return Track(lost, shape, lost_reason=word.lost_reason)
        true = true_pose(frames.t_ns)
        quats = true.quats_xyzw.copy()
        for side, way in (("left", 1.0), ("right", -1.0)):
            raised = rotations.exp(np.array([0.0, 0.0, way * word.arms_rad]))
            for bone in ("UpperArm", "LowerArm", "Hand"):
                joint = INDEX[side + bone]
                quats[joint] = rotations.multiply(raised, quats[joint])
        for knee in ("leftLowerLeg", "rightLowerLeg"):
            bent = rotations.exp(np.array([word.knees_rad, 0.0, 0.0]))
            quats[INDEX[knee]] = rotations.multiply(bent, quats[INDEX[knee]])
        pose = Pose(true.root_m + (word.off_m, 0.0, 0.0), rotations.canonical(quats))
        body = BodyState(
            frames.t_ns,
            word.tracking,
            self.name,
            pose,
            joint_positions(skeleton_of(shape), pose),
            np.full(N_JOINTS, self._confidence),
            tuple(frames.frames),
            uncertainty_m=np.full(N_JOINTS, 0.02),
        )
        return Track(body, shape, word.quality)


class ScriptedGuided(ScriptedTracker):
    """One that can be guided, too. prepared: for which times it was; fails_at_s: from when on that fails."""

    def __init__(self, name: str, script: Sequence[Word], confidence: float) -> None:
        super().__init__(name, script, confidence)
        self.prepared: list[int] = []
        self.fails_at_s = float("inf")

    def prepare(self, frames: FrameSet) -> None:
        if seconds(frames.t_ns) >= self.fails_at_s:
            raise ConfigError("a frame of another size", self.name, "calibrate again")
        self.prepared.append(frames.t_ns)

    def step_guided(self, frames: FrameSet, shape: BodyShape, upper: BodyState) -> Track:
        self.guided_by[frames.t_ns] = upper
        return self.step(frames, shape)


@dataclass
class Scene:
    """A supervisor over a scripted `colour` and a scripted `flex`."""

    colour: ScriptedTracker
    flex: ScriptedGuided
    auto: Supervisor

    def run(
        self, until_s: float, cameras: Callable[[float], int] = lambda _: 2, hz: float = 30.0
    ) -> list[BodyState]:
        """What is told, from 0 s on."""
        return [
            self.auto.step(frame_set(round(k * 1e9 / hz), cameras(k / hz)), SHAPE).body
            for k in range(round(until_s * hz))
        ]


def frame_set(t_ns: int, cameras: int) -> FrameSet:
    """Frames of so many cameras."""
    return FrameSet(t_ns, {f"cam{i}": Frame(f"cam{i}", 0, t_ns, _PIXEL) for i in range(cameras)})


def scene(colour: Sequence[Word], flex: Sequence[Word]) -> Scene:
    """Both from their scripts."""
    one, other = ScriptedTracker("colour", colour, 0.9), ScriptedGuided("flex", flex, 0.5)
    candidates = [Candidate(one, KINDS["colour"]), Candidate(other, KINDS["flex"])]
    return Scene(one, other, Supervisor(candidates, Params()))


def at(bodies: Sequence[BodyState], t_s: float) -> BodyState:
    """The first told at that time or later."""
    return next(body for body in bodies if body.t_ns >= nanoseconds(t_s) - 1000)


def joints_of(body: BodyState) -> Floats:
    """Of somebody who is not lost."""
    assert body.joints_m is not None
    return body.joints_m
