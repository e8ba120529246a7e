"""For each registered tracker: how to build it, frames it can track, and frames of an empty room."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import numpy as np

from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.published.wang2011.build import build_wang2011_tracker
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.sim.renderer import camera_renderers
from mocapd.sim.setup import setup_of
from mocapd.sim.world import World
from mocapd.trackers.registry import Resources, build
from mocapd.tracking.base import Tracker
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.types import Frame, FrameSet
from tests.sim import small
from tests.sim.simulated_calibration import calibration_of_setup
from tests.tracking.profiles import (
    auto_tracker,
    hecht2009_tracker,
    markerless_tracker,
    rao_hodges_tracker,
    shirt_tracker,
)
from tests.tracking.stepping import Stepping

START_NS = 86_400_000_000_000  # a day after boot: times are large on a machine that stays on
PERIOD_NS = 33_333_333
N_PERSON, N_EMPTY = 10, 6
N_BEFORE = 24  # of an empty room, in which a background is learned
N_STAYS = 22  # of somebody in it after that
LIVE_AFTER = N_BEFORE + 6


@dataclass(frozen=True)
class TrackerCase:
    """`person`: in order of time, long enough to become live in the first `half` frames and stay so; `empty`: nobody in
    sight; carriers: which cues its bodies may be carried by, none for a tracker that names itself."""

    tracker: Stepping
    person: list[FrameSet]
    empty: list[FrameSet]
    half: int
    carriers: tuple[str, ...] = ()


def frame_sets(
    pixels: Mapping[str, list[np.ndarray]],
    start_ns: int = START_NS,
    offset_ns: Mapping[str, int] | None = None,
) -> list[FrameSet]:
    """Read-only frames at 30 Hz from each camera's pictures; the first camera gives the set's time."""
    offset_ns = offset_ns or {}
    names = list(pixels)
    out = []
    for k in range(len(pixels[names[0]])):
        frames = {}
        for name in names:
            picture = np.ascontiguousarray(pixels[name][k])
            picture.flags.writeable = False
            t_ns = start_ns + k * PERIOD_NS + offset_ns.get(name, 0)
            frames[name] = Frame(name, k, t_ns, picture)
        t_ns = frames[names[0]].t_ns
        spread_ns = max(abs(frame.t_ns - t_ns) for frame in frames.values())
        out.append(FrameSet(t_ns, frames, spread_ns))
    return out


def grey_room(n: int, seed: int) -> list[np.ndarray]:
    """n noisy pictures (480,640,3) of a wall."""
    rng = np.random.default_rng(seed)
    return [rng.integers(90, 120, (480, 640, 3), dtype=np.uint8) for _ in range(n)]


def canned_case() -> TrackerCase:
    sets = frame_sets(
        {"cam0": grey_room(8, 0), "cam1": grey_room(8, 1)}, offset_ns={"cam1": 11_000_000}
    )
    known = Calibration(wearer=Wearer(1.7))
    tracker = build("canned", known, Resources())
    return TrackerCase(Stepping(tracker, wearer_shape(known)), sets, sets, len(sets) // 2)


@dataclass(frozen=True, eq=False)
class Filmed:
    """What trackers are built from, and what is shown to them."""

    known: Calibration
    person: list[FrameSet]
    empty: list[FrameSet]


@cache
def filmed() -> Filmed:
    """Two simulated webcams in a room with things in it."""
    cameras = [camera | {"size_px": [320, 240]} for camera in small.table()["cameras"]]
    scenario = small.scenario(cameras=cameras)
    renderers = camera_renderers(World(scenario))
    known = calibration_of_setup(setup_of(scenario, renderers))
    offset_ns = {"right": 11_000_000}
    person = {r.camera.name: [r.frame(i) for i in range(N_PERSON)] for r in renderers}
    empty = {
        r.camera.name: [r.picture(None, np.ones(2), noise_key=i) for i in range(N_EMPTY)]
        for r in renderers
    }
    return Filmed(
        known,
        frame_sets(person, offset_ns=offset_ns),
        frame_sets(empty, offset_ns=offset_ns),
    )


def shirt_case(
    build_tracker: Callable[[Calibration, PoseDatabase], Tracker],
    database: PoseDatabase,
    *carriers: str,
) -> TrackerCase:
    shown = filmed()
    tracker = Stepping(build_tracker(shown.known, database), wearer_shape(shown.known))
    return TrackerCase(tracker, shown.person, shown.empty, N_PERSON // 2, carriers)


BEHIND = {"name": "behind", "position_m": [0.3, 1.5, -3.2], "look_at_m": [0.0, 1.0, 0.0]}


@cache
def filmed_from_empty(ring: bool = False) -> Filmed:
    """The same room in steady light, seen empty for a while before somebody stands in it and slowly moves. ring: the two
    cameras stand back, so that they see feet and hands, and a third one is behind the person."""
    cameras = [camera | {"size_px": [320, 240]} for camera in small.table()["cameras"]]
    whole = {}
    if ring:
        for camera in cameras:
            camera["position_m"] = [1.3 * x for x in camera["position_m"]]
        cameras.append(BEHIND | {"size_px": [320, 240]})
        whole = {"room": {}, "body": {"whole": True}, "clothes": {"shirt": "plain"}}
    lights = [{**light, "events": []} for light in small.table()["lights"]]
    turns = {"t_s": 3.0, "pose": "relaxed", "at_m": [0.1, 0.1], "yaw_deg": 20.0}
    motion = {"keyframes": [{"t_s": 0.0, "pose": "t_pose"}, turns]}
    scenario = small.scenario(cameras=cameras, lights=lights, motion=motion, loop_s=6.0, **whole)
    renderers = camera_renderers(World(scenario))
    empty = {
        r.camera.name: [r.picture(None, np.ones(2), noise_key=i) for i in range(N_BEFORE)]
        for r in renderers
    }
    person = {r.camera.name: [r.frame(i) for i in range(N_STAYS)] for r in renderers}
    shown = {name: empty[name] + person[name] for name in empty}
    known = calibration_of_setup(setup_of(scenario, renderers))
    return Filmed(known, frame_sets(shown), frame_sets(empty))


def plain_case(
    build_tracker: Callable[[Calibration], Tracker], *carriers: str, ring: bool = False
) -> TrackerCase:
    shown = filmed_from_empty(ring)
    tracker = Stepping(build_tracker(shown.known), wearer_shape(shown.known))
    return TrackerCase(tracker, shown.person, shown.empty, LIVE_AFTER, carriers)


# One line per tracker of mocapd.trackers.registry.TRACKERS; a small database is enough for those of the shirt.
CASES: Mapping[str, Callable[[PoseDatabase], TrackerCase]] = {
    "auto": lambda database: shirt_case(
        auto_tracker, database, "shirt", "clothes", "shirt+clothes"
    ),
    "canned": lambda _: canned_case(),
    "shirt": lambda database: shirt_case(shirt_tracker, database, "shirt"),
    "wang2011": lambda database: shirt_case(build_wang2011_tracker, database),
    "markerless": lambda _: plain_case(markerless_tracker, "clothes"),
    "hecht2009": lambda _: plain_case(hecht2009_tracker),
    "rao_hodges": lambda _: plain_case(rao_hodges_tracker, ring=True),
}
