"""A simulated wearer before two cameras, for the steps Colours and Body."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from mocapd.body.shape import FACTORS
from mocapd.sim.renderer import CameraRenderer, camera_renderers
from mocapd.sim.setup import scribble_picture
from mocapd.sim.world import World, rig_of
from mocapd.types import Bytes, Floats, Frame, FrameSet, LabelledPicture, Rig
from tests.sim import small

FPS_HZ = 30.0
ODD: Mapping[str, float] = {
    "torso_length": 1.05,
    "shoulder_width": 0.94,
    "upper_arm_length": 1.04,
    "forearm_length": 0.92,
    "torso_width": 1.1,
    "torso_depth": 1.05,
    "arm_girth": 1.1,
}
BENDS = [
    {"t_s": 0.0, "pose": "t_pose"},
    {"t_s": 0.8, "pose": "goalpost"},
    {"t_s": 1.6, "pose": "arms_forward"},
]


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedWearer:
    """What the cameras see: the T-pose with a user's own strokes, and arm bends as frame sets."""

    rig: Rig
    stature_m: float
    factors: Floats
    scribbles: Mapping[str, LabelledPicture]
    patch: Mapping[str, Bytes]
    renderers: tuple[CameraRenderer, ...]
    truth: World

    @property
    def pictures(self) -> dict[str, Bytes]:
        """The T-pose."""
        return {name: one.pixels for name, one in self.scribbles.items()}

    def frame_set(self, number: int, begin_ns: int = 1_000_000_000) -> FrameSet:
        """Of the arm bends, each camera at its own instant."""
        frames = {}
        for renderer in self.renderers:
            t_ns = begin_ns + round(1e9 * renderer.exposure_s(number))
            name = renderer.camera.name
            frames[name] = Frame(name, number, t_ns, renderer.frame(number))
        return FrameSet(max(frame.t_ns for frame in frames.values()), frames)


@cache
def wearer(odd: bool = False) -> SimulatedWearer:
    """Two cameras of 480x360 in an even light; `odd`: not of the mean body's proportions."""
    table: dict[str, Any] = small.table(
        loop_s=2.4,
        fps_hz=FPS_HZ,
        motion={"keyframes": BENDS, "sway_deg": 0.5},
        body={"stature_m": 1.7, **(ODD if odd else {})},
    )
    for camera in table["cameras"]:
        camera |= {"size_px": [480, 360], "dropped": 0.0}
    for light in table["lights"]:
        light.pop("events", None)
    scenario = small.scenario(**table)
    world = World(scenario)
    renderers = tuple(camera_renderers(world))
    pose = world.at(scenario.scribble_s).pose
    return SimulatedWearer(
        rig_of(scenario),
        scenario.body.stature_m,
        np.array([getattr(scenario.body, name) for name in FACTORS]),
        {r.camera.name: scribble_picture(scenario, r) for r in renderers},
        {r.camera.name: r.labels(pose)[0] for r in renderers},
        renderers,
        world,
    )
