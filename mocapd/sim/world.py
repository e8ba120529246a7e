"""The simulated world as a pure function of time: ground truth that no camera has to coordinate."""

from collections.abc import Callable
from dataclasses import dataclass

import msgspec
import numpy as np

from mocapd.body.shape import FACTORS, WHOLE_FACTORS, BodyShape, skeleton_of
from mocapd.body.skeleton import joint_positions
from mocapd.geometry import rotations
from mocapd.sim.person.motion import Motion, compile_motion, pose_at
from mocapd.sim.person_spec import Screen
from mocapd.sim.scenario import CameraSpec, Light, Scenario
from mocapd.sim.scenario_values import within
from mocapd.types import Camera, Floats, Pose, Rig, Skeleton

PoseAt = Callable[[float], Pose]  # of a time [s]
Performed = Callable[[Skeleton], PoseAt]  # by a person of this skeleton


@dataclass(frozen=True, slots=True, eq=False)
class WorldState:
    """Truth at one instant: pose, joints_m (J,3), level of each light (L,), whether she is there, how far
    her jacket is on, 0..1."""

    t_s: float
    pose: Pose
    joints_m: Floats
    light_levels: Floats
    person_present: bool
    jacket: float


class World:
    """Everything that moves in a scenario. Holds no state: `at` of one time is always the same."""

    def __init__(
        self,
        scenario: Scenario,
        performed: Performed | None = None,
        screen: Screen | None = None,
    ) -> None:
        """performed: what the person does in place of the scenario's motion; screen: on which they are shown, if any."""
        self.scenario = scenario
        self.shape = body_shape(scenario)
        self.skeleton: Skeleton = skeleton_of(self.shape)
        self._pose_at = (
            performed(self.skeleton) if performed else _looping_pose(scenario, self.skeleton)
        )
        self.screen = screen
        self.others = tuple(
            World(_of_bystander(scenario, i), screen=other.screen)
            for i, other in enumerate(scenario.others)
        )

    def at(self, t_s: float) -> WorldState:
        """The truth at t_s [s]; motion and lights repeat every `loop_s`."""
        pose = self.pose(t_s)
        return WorldState(
            t_s=t_s,
            pose=pose,
            joints_m=joint_positions(self.skeleton, pose),
            light_levels=light_levels(self.scenario, t_s),
            person_present=self.present(t_s),
            jacket=self.jacket(t_s),
        )

    def present(self, t_s: float) -> bool:
        """Whether the person is there."""
        scenario = self.scenario
        t = float(np.mod(t_s, scenario.loop_s))
        return t_s >= scenario.person_appears_s and not within(scenario.absences, t)

    def jacket(self, t_s: float) -> float:
        """How far the person's jacket is on, 0..1."""
        clothes = self.scenario.clothes
        if clothes.jacket is None:
            return 0.0
        steps = [(event.t_s, event.jacket, event.over_s) for event in clothes.events]
        return _level(steps, float(np.mod(t_s, self.scenario.loop_s)))

    def pose(self, t_s: float) -> Pose:
        """The pose alone."""
        return self._pose_at(t_s)


def _looping_pose(scenario: Scenario, skeleton: Skeleton) -> PoseAt:
    motion: Motion = compile_motion(scenario, skeleton)
    return lambda t_s: pose_at(motion, t_s)


def body_shape(scenario: Scenario) -> BodyShape:
    """The wearer's shape."""
    body = scenario.body
    names = WHOLE_FACTORS if body.whole else FACTORS
    return BodyShape(body.stature_m, np.array([getattr(body, name) for name in names]))


def _of_bystander(scenario: Scenario, i: int) -> Scenario:
    other = scenario.others[i]
    return msgspec.structs.replace(
        scenario, seed=scenario.seed + 101 * (i + 1), body=other.body, clothes=other.clothes, motion=other.motion,
        others=[], absences=[], person_appears_s=0.0,
    )  # fmt: skip


def is_out(scenario: Scenario, camera: CameraSpec, frame: int) -> bool:
    """Whether a camera is unplugged when it would expose a frame of the world."""
    t_s = frame / scenario.fps_hz + camera.clock_offset_s
    return within(camera.outages, float(np.mod(t_s, scenario.loop_s)))


def light_levels(scenario: Scenario, t_s: float) -> Floats:
    """Level (L,) of each light at t_s, as a factor on its intensity."""
    t = float(np.mod(t_s, scenario.loop_s))
    return np.array([_level(_steps(light), t) for light in scenario.lights])


def _steps(light: Light) -> list[tuple[float, float, float]]:
    return [(event.t_s, event.level, event.over_s) for event in light.events]


def _level(steps: list[tuple[float, float, float]], t_s: float) -> float:
    """The level after steps of (time, level, duration); the loop starts at the last step's level."""
    level = steps[-1][1] if steps else 1.0
    for from_s, goal, over_s in steps:
        if t_s >= from_s:
            progress = min((t_s - from_s) / over_s, 1.0)
            level += progress * (goal - level)
    return level


def rig_of(scenario: Scenario) -> Rig:
    """The calibrated cameras, exactly as they are rendered."""
    return Rig(tuple(_camera(spec) for spec in scenario.cameras))


def _camera(spec: CameraSpec) -> Camera:
    """OpenCV axes from position and target: z to the target, x right, y down."""
    position, target = np.array(spec.position_m), np.array(spec.look_at_m)
    z = target - position
    z /= np.linalg.norm(z)
    x = np.cross(z, np.array([0.0, 1.0, 0.0]))
    x /= np.linalg.norm(x)
    R = np.stack([x, np.cross(z, x), z])
    roll = rotations.to_matrix(rotations.exp(np.array([0.0, 0.0, np.radians(spec.roll_deg)])))
    R = roll @ R
    width, height = spec.size_px
    if spec.focal_px is not None:
        fx, fy = spec.focal_px
    else:
        fx = fy = 0.5 * width / np.tan(0.5 * np.radians(spec.fov_deg))
    cx, cy = spec.centre_px if spec.centre_px is not None else ((width - 1) / 2, (height - 1) / 2)
    K = np.array([[fx, 0.0, cx], [0.0, fy, cy], [0.0, 0.0, 1.0]])
    return Camera(spec.name, spec.size_px, K, np.array(spec.dist), R, -R @ position)
