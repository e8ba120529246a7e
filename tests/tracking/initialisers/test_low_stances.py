"""Somebody without a shirt who sits from the first frame to the last is found and followed."""

from functools import cache

import msgspec
import numpy as np
import pytest

from mocapd.sim.renderer import camera_renderers
from mocapd.sim.setup import setup_of
from mocapd.sim.world import World
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import Bytes, Floats, Frame, FrameSet, Tracking
from tests.sim import small
from tests.sim.simulated_calibration import calibration_of_setup
from tests.tracking.profiles import markerless_tracker
from tests.tracking.stances.low_stances import STANCES, performed
from tests.tracking.stepping import Stepping

pytestmark = pytest.mark.kernels

N_EMPTY, N_PERSON = 22, 20


@cache
def seated() -> tuple[Stepping, list[FrameSet], list[Floats]]:
    """A tracker, what it is shown, and where the joints (J,3) of the person are in the last N_PERSON frames."""
    table = small.table()
    for camera in table["cameras"]:
        camera |= {"size_px": [320, 240], "dropped": 0.0, "clock_offset_s": 0.0}
    for light in table["lights"]:
        light["events"] = []
    table |= {"clothes": {"shirt": "plain", "top_srgb": [150, 60, 60]}, "body": {"whole": True}}
    scenario = small.scenario(**table)
    seated_low = msgspec.structs.replace(scenario, loop_s=8.0)
    world = World(seated_low, performed(STANCES["sits"], 10.0))
    renderers = camera_renderers(world)
    levels = np.ones(len(scenario.lights))
    empty = {one.camera.name: one.picture(None, levels, 0) for one in renderers}
    shown = [empty] * N_EMPTY
    shown += [{one.camera.name: one.frame(k) for one in renderers} for k in range(N_PERSON)]
    joints_m = [world.at(renderers[0].exposure_s(k)).joints_m for k in range(N_PERSON)]
    known = calibration_of_setup(setup_of(scenario, renderers))
    sets = [_set(pictures, k) for k, pictures in enumerate(shown)]
    return Stepping(markerless_tracker(known), wearer_shape(known)), sets, joints_m


def _set(pictures: dict[str, Bytes], k: int) -> FrameSet:
    t_ns = 1_000_000_000 + k * 33_333_333
    return FrameSet(t_ns, {name: Frame(name, k, t_ns, one) for name, one in pictures.items()}, 0)


def test_somebody_who_sits_from_the_start_is_found() -> None:
    tracker, frames, joints_m = seated()
    tracks = [tracker.step(one) for one in frames]
    assert all(one.body.tracking is Tracking.LOST for one in tracks[: N_EMPTY + 1])
    last = tracks[-1].body
    assert last.tracking is Tracking.LIVE
    assert last.joints_m is not None
    assert np.linalg.norm(last.joints_m - joints_m[-1], axis=1).mean() < 0.1
