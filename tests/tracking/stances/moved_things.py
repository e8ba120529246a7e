"""Rooms in which things are moved and nobody is: who is found there is a ghost."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import msgspec
import numpy as np

from mocapd.calibration.calibration_record import Calibration
from mocapd.sim.renderer import CameraRenderer, Set, figure_of, furnished_set
from mocapd.sim.scenario import Thing
from mocapd.sim.setup import setup_of
from mocapd.sim.world import World
from mocapd.types import Bytes, Frame, FrameSet
from tests.sim.simulated_calibration import calibration_of_setup
from tests.tracking.stances.sessions import scenario_of

N_EMPTY, N_MOVED, STAYS = 24, 54, 9  # frames; STAYS: at each place
_PERIOD_NS, _START_NS = 33_333_333, 50_000_000_000_000
_WAY_M = 0.9


@dataclass(frozen=True, slots=True)
class MovedThing:
    """A thing of this size [m] that appears after the empty room and is pushed to and fro before cameras of this rig."""

    name: str
    rig: str
    size_m: tuple[float, float, float]
    srgb: tuple[int, int, int]
    kind: Literal["box", "ball", "tree"] = "box"


THINGS = (
    MovedThing("chair", "pair", (0.42, 0.9, 0.42), (120, 84, 54)),
    MovedThing("chair_stereo", "stereo", (0.42, 0.9, 0.42), (60, 60, 110)),
    MovedThing("cupboard", "pair", (0.5, 1.7, 0.4), (196, 120, 40)),
    MovedThing("cupboard_stereo", "stereo", (0.5, 1.7, 0.4), (200, 196, 190)),
    MovedThing("ball", "stereo", (0.75, 0.75, 0.75), (160, 50, 60), "ball"),
    MovedThing("plant", "pair", (0.6, 1.5, 0.6), (70, 100, 60), "tree"),
    MovedThing("chair_ring", "ring", (0.45, 1.1, 0.45), (90, 60, 50)),
)


def filmed(thing: MovedThing) -> tuple[Calibration, list[FrameSet]]:
    """The calibration of its cameras, and what they see."""
    scenario = scenario_of(thing.name, thing.rig, 20 + THINGS.index(thing))
    small = [msgspec.structs.replace(one, size_px=(320, 240)) for one in scenario.cameras]
    scenario = msgspec.structs.replace(scenario, cameras=small)
    world = World(scenario)
    figures = [figure_of(world)]

    def seeing(stage: Set) -> list[CameraRenderer]:
        cameras = range(len(scenario.cameras))
        return [CameraRenderer(world, figures, stage, i, samples=1) for i in cameras]

    before = seeing(furnished_set(scenario))
    known = calibration_of_setup(setup_of(scenario, before))
    levels = np.ones(len(scenario.lights))

    def pictures(renderers: Sequence[CameraRenderer], noise: int) -> dict[str, Bytes]:
        return {one.camera.name: one.picture(None, levels, noise_key=noise) for one in renderers}

    shown = [pictures(before, 0)] * N_EMPTY
    for k in range(N_MOVED // STAYS):
        x_m = 0.5 * _WAY_M * np.sin(2.0 * np.pi * k / 6.0)
        moved = Thing(
            kind=thing.kind, base_m=(float(x_m), 0.0, 0.1), size_m=thing.size_m, yaw_deg=12.0 * k, srgb=thing.srgb
        )  # fmt: skip
        room = msgspec.structs.replace(scenario.room, things=(*scenario.room.things, moved))
        stage = furnished_set(msgspec.structs.replace(scenario, room=room))
        shown += [pictures(seeing(stage), k + 1)] * STAYS
    sets = []
    for k, seen in enumerate(shown):
        t_ns = _START_NS + k * _PERIOD_NS
        frames = {name: Frame(name, k, t_ns, pixels) for name, pixels in seen.items()}
        sets.append(FrameSet(t_ns, frames, 0))
    return known, sets
