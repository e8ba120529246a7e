"""Somebody in plain clothes in a small room that was seen empty before, rendered once, and the truth."""

from dataclasses import dataclass

import numpy as np

from mocapd.calibration.calibration_record import Calibration
from mocapd.sim.renderer import camera_renderers
from mocapd.sim.setup import setup_of
from mocapd.sim.world import World
from mocapd.types import Bytes, Floats, Frame, FrameSet
from tests.sim import small
from tests.sim.kept_film import kept
from tests.sim.simulated_calibration import calibration_of_setup

START_NS = 50_000_000_000_000
PERIOD_NS = 33_333_333
N_EMPTY, N_PERSON = 22, 40


@dataclass(frozen=True, slots=True, eq=False)
class PlainFilm:
    """frames: N_EMPTY of the room, then somebody, at joints_m[i] (J,3) in frame N_EMPTY + i; empty: the room on."""

    known: Calibration
    frames: list[FrameSet]
    joints_m: list[Floats]
    empty: list[FrameSet]


def _sets(pictures: list[dict[str, Bytes]], first: int) -> list[FrameSet]:
    out = []
    for k, shown in enumerate(pictures, start=first):
        t_ns = START_NS + k * PERIOD_NS
        out.append(FrameSet(t_ns, {n: Frame(n, k, t_ns, p) for n, p in shown.items()}, 0))
    return out


@kept
def plain_film(to_m: tuple[float, float] = (0.1, 0.1), has_third: bool = False) -> PlainFilm:
    """Two cameras of 320x240 whose views cross, or three, in steady light; the person goes as far as to_m (x, z), the arms
    raised."""
    table = small.table()
    if has_third:
        table["cameras"].append(
            table["cameras"][0] | {"name": "back", "position_m": [0.6, 1.5, -2.8]}
        )
    for camera in table["cameras"]:
        camera |= {"size_px": [320, 240], "dropped": 0.0, "clock_offset_s": 0.0}
    for light in table["lights"]:
        light["events"] = []
    raised = {"t_s": 1.4, "pose": "arms_up", "at_m": list(to_m), "yaw_deg": 15.0}
    table["motion"] = {"keyframes": [{"t_s": 0.0, "pose": "relaxed"}, raised]}
    table["clothes"] = {"shirt": "plain"}
    table["body"] = {"whole": True}
    table["loop_s"] = 4.0
    scenario = small.scenario(**table)
    world = World(scenario)
    renderers = camera_renderers(world)
    nobody = [
        {r.camera.name: r.picture(None, np.ones(len(table["lights"])), k) for r in renderers}
        for k in range(N_EMPTY + 40)
    ]
    person = [{r.camera.name: r.frame(k) for r in renderers} for k in range(N_PERSON)]
    joints = [world.at(renderers[0].exposure_s(k)).joints_m for k in range(N_PERSON)]
    known = calibration_of_setup(setup_of(scenario, renderers))
    frames = _sets(nobody[:N_EMPTY] + person, 0)
    return PlainFilm(known, frames, joints, _sets(nobody[N_EMPTY:], len(frames)))
