"""The simulated world as a pure function of time: ground truth that no camera has to coordinate."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mocapd.body.shape import FACTORS, BodyShape, skeleton_of
from mocapd.body.skeleton import joint_positions
from mocapd.geometry import rotations
from mocapd.sim.person.motion import Motion, compile_motion, pose_at
from mocapd.sim.scenario import CameraSpec, Light, Scenario
from mocapd.types import Camera, Floats, Pose, Rig, Skeleton

PoseAt = Callable[[float], Pose]  # of a time [s]
Performed = Callable[[Skeleton], PoseAt]  # by a person of this skeleton


@dataclass(frozen=True, slots=True, eq=False)
class WorldState:
    """Truth at one instant: pose, joints_m (J,3), level of each light (L,), whether she is there."""

    t_s: float
    pose: Pose
    joints_m: Floats
    light_levels: Floats
    person_present: bool


class World:
    """Everything that moves in a scenario. Holds no state: `at` of one time is always the same."""

    def __init__(self, scenario: Scenario, performed: Performed | None = None) -> None:
        """performed: what the person does in place of the scenario's motion."""
        self.scenario = scenario
        self.shape = body_shape(scenario)
        self.skeleton: Skeleton = skeleton_of(self.shape)
        self._pose_at = performed(self.skeleton) if performed else _looped(scenario, self.skeleton)

    def at(self, t_s: float) -> WorldState:
        """The truth at t_s [s]; motion and lights repeat every `loop_s`."""
        pose = self.pose(t_s)
        return WorldState(
            t_s=t_s,
            pose=pose,
            joints_m=joint_positions(self.skeleton, pose),
            light_levels=light_levels(self.scenario, t_s),
            person_present=t_s >= self.scenario.person_appears_s,
        )

    def pose(self, t_s: float) -> Pose:
        """The pose alone."""
        return self._pose_at(t_s)


def _looped(scenario: Scenario, skeleton: Skeleton) -> PoseAt:
    motion: Motion = compile_motion(scenario, skeleton)
    return lambda t_s: pose_at(motion, t_s)


def body_shape(scenario: Scenario) -> BodyShape:
    """The wearer's shape."""
    body = scenario.body
    return BodyShape(body.stature_m, np.array([getattr(body, name) for name in FACTORS]))


def light_levels(scenario: Scenario, t_s: float) -> Floats:
    """Level (L,) of each light at t_s, as a factor on its intensity."""
    t = float(np.mod(t_s, scenario.loop_s))
    return np.array([_level(light, t) for light in scenario.lights])


def _level(light: Light, t_s: float) -> float:
    level = light.events[-1].level if light.events else 1.0
    for event in light.events:
        if t_s >= event.t_s:
            progress = min((t_s - event.t_s) / event.over_s, 1.0)
            level += progress * (event.level - level)
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
