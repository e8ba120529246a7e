"""The demo's person: what she reaches for in one loop, told to the simulated cameras and to the shooter alike.

The simulated cameras show a loop that is drawn beforehand, so she cannot see balls. Instead shooter and person
follow one script: the shooter shoots to where she reaches, when she does; at a few places she is wrong.
"""

from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np
import tomli_w

from mocapd.assets import asset_path
from mocapd.body.shape import skeleton_of
from mocapd.body.skeleton import INDEX
from mocapd.sim.person_spec import MotionSpec, PoseKeyframe
from mocapd.sim.scenario import Scenario, load_scenario
from mocapd.sim.world import body_shape
from mocapd.types import Skeleton

LOOP_S = 24.0
POSED_S = 2.0  # how long the T-pose is held at the loop's beginning
FPS_HZ = 30.0
_AT_REST_S = 0.55  # before and after a reach
_HELD_S = 0.12  # before and after the ball comes
FORWARD_M = 0.20  # how far before her the hand is


@dataclass(frozen=True, slots=True)
class Reaching:
    """at_s: of the loop; x_m, y_m: where the hand goes, seen from where she stands, her left is +x; miss_m: how far
    from there the ball comes; side_m: a step aside [m]."""

    at_s: float
    x_m: float
    y_m: float
    side_m: float = 0.0
    miss_m: tuple[float, float] = (0.0, 0.0)


SCRIPT = (
    Reaching(4.0, 0.80, 1.45),
    Reaching(5.9, -0.75, 1.70, -0.10),
    Reaching(7.8, -0.85, 1.10, -0.20),
    Reaching(9.7, 0.55, 1.85, 0.05, (-0.75, -0.5)),
    Reaching(11.6, 0.95, 1.25, 0.25),
    Reaching(13.5, -0.35, 1.90, 0.0),
    Reaching(15.4, -0.95, 1.50, -0.25),
    Reaching(17.3, 0.70, 0.95, 0.10, (0.45, 0.3)),
    Reaching(19.2, 0.45, 1.80, 0.0),
    Reaching(21.1, -0.80, 1.30, -0.10),
)


def demo_scenario() -> Scenario:
    """The demo's living room with two webcams, in which she keeps goal; no lamp goes out."""
    room = load_scenario(asset_path("scenarios") / "living_room.toml")
    replace = msgspec.structs.replace
    return replace(
        room,
        name="goalkeeper",
        loop_s=LOOP_S,
        fps_hz=FPS_HZ,
        motion=MotionSpec(keyframes=_keyframes(skeleton_of(body_shape(room))), sway_deg=1.0),
        lights=tuple(replace(light, events=()) for light in room.lights),
    )


def scenario_toml(scenario: Scenario) -> str:
    """As a file that `sim:FILE.toml` reads."""
    return tomli_w.dumps(_without_none(msgspec.to_builtins(scenario)))


def _keyframes(skeleton: Skeleton) -> list[PoseKeyframe]:
    """T-pose, then ready, reaching, ready, reaching ..."""
    keys = [
        PoseKeyframe(t_s=0.0, pose="t_pose", at_m=(0.0, 0.0), yaw_deg=0.0),
        PoseKeyframe(t_s=POSED_S, pose="t_pose"),
        PoseKeyframe(t_s=POSED_S + _AT_REST_S, pose="guard"),
    ]
    for one in SCRIPT:
        reached = _reaching_pose(one, skeleton)
        keys += [
            PoseKeyframe(t_s=one.at_s - _AT_REST_S, pose="guard", at_m=(0.0, 0.0)),
            msgspec.structs.replace(reached, t_s=one.at_s - _HELD_S),
            msgspec.structs.replace(reached, t_s=one.at_s + _HELD_S),
            PoseKeyframe(t_s=one.at_s + _AT_REST_S, pose="guard", at_m=(0.0, 0.0)),
        ]
    return [*keys, PoseKeyframe(t_s=LOOP_S - 0.6, pose="guard", at_m=(0.0, 0.0))]


def _reaching_pose(one: Reaching, skeleton: Skeleton) -> PoseKeyframe:
    """The arm of that side stretched to the place, as seen from its shoulder."""
    side = "left" if one.x_m > 0 else "right"
    shoulder_m = skeleton.rest_m[INDEX[f"{side}UpperArm"]]
    x, y, _ = np.array([one.x_m, one.y_m, 0.0]) - shoulder_m
    arm = (float(x), float(y), FORWARD_M)
    at_m = (one.side_m, 0.0)
    if side == "left":
        return PoseKeyframe(t_s=one.at_s, pose="guard", at_m=at_m, left_arm=(arm, arm))
    return PoseKeyframe(t_s=one.at_s, pose="guard", at_m=at_m, right_arm=(arm, arm))


def _without_none(tree: Any) -> Any:
    """TOML has no word for what is absent."""
    if isinstance(tree, dict):
        return {key: _without_none(item) for key, item in tree.items() if item is not None}
    if isinstance(tree, list | tuple):
        return [_without_none(item) for item in tree]
    return tree
