"""Frames of a person in a small simulated room, and the truth, rendered once."""

from dataclasses import dataclass

import numpy as np

from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.sim.renderer import CameraRenderer, camera_renderers
from mocapd.sim.scenario import Scenario
from mocapd.sim.setup import setup_of
from mocapd.sim.world import World
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import Bytes, Floats, Frame, FrameSet
from tests.sim import small
from tests.sim.simulated_calibration import calibration_of_setup
from tests.tracking.profiles import shirt_tracker
from tests.tracking.stepping import Stepping

N = 36
START_NS = 50_000_000_000_000
Pictures = dict[str, Bytes]


@dataclass(frozen=True, slots=True, eq=False)
class Filmed:
    """pictures[i] by camera with the person at `joints_m[i]` (J,3); `empty`: the room alone."""

    scenario: Scenario
    renderers: list[CameraRenderer]
    pictures: list[Pictures]
    empty: list[Pictures]
    joints_m: list[Floats]

    def frame_sets(self, shown: list[Pictures], first: int = 0) -> list[FrameSet]:
        """Pictures at the cameras' own times, frame after frame from number `first` on."""
        out = []
        for seq, pictures in enumerate(shown, start=first):
            frames = {}
            for renderer in self.renderers:
                name = renderer.camera.name
                t_ns = START_NS + round(renderer.exposure_s(seq) * 1e9)
                if name in pictures:
                    frames[name] = Frame(name, seq, t_ns, pictures[name])
            asked = START_NS + round(self.renderers[0].exposure_s(seq) * 1e9)
            spread = max((abs(f.t_ns - asked) for f in frames.values()), default=0)
            out.append(FrameSet(asked, frames, spread))
        return out


def film(stands: bool = False, count: int = N) -> Filmed:
    """Two cameras of 320x240, one 11 ms behind the other, in steady light. stands: the person has legs and a head, too, and
    does not move."""
    table = small.table()
    if stands:
        table["body"] = {**table.get("body", {}), "whole": True}
        table["motion"] = {"keyframes": [{"t_s": 0.0, "pose": "relaxed"}]}
    for camera in table["cameras"]:
        camera |= {"size_px": [320, 240], "dropped": 0.0}
    for light in table["lights"]:
        light["events"] = []
    scenario = small.scenario(**table)
    world = World(scenario)
    renderers = camera_renderers(world)
    levels = np.ones(len(table["lights"]))
    pictures = [{r.camera.name: _still(r.frame(i)) for r in renderers} for i in range(count)]
    joints = [world.at(renderers[0].exposure_s(i)).joints_m for i in range(count)]
    empty = [
        {r.camera.name: _still(r.picture(None, levels, count + i)) for r in renderers}
        for i in range(10)
    ]
    return Filmed(scenario, renderers, pictures, empty, joints)


def _still(pixels: Bytes) -> Bytes:
    pixels.flags.writeable = False
    return pixels


def tracker_of(filmed: Filmed, database: PoseDatabase) -> Stepping:
    """The profile `shirt`, calibrated on the film's own room as a user would."""
    known = calibration_of_setup(setup_of(filmed.scenario, filmed.renderers))
    return Stepping(shirt_tracker(known, database), wearer_shape(known))
