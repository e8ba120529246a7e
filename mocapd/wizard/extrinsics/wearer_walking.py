"""The job of the room without a board: the wearer is followed in every camera alone, then the room is solved."""

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from mocapd.calibrate.self_calibration.patch_tracks import Moment, PatchTracks, unplaced
from mocapd.calibrate.self_calibration.self_calibration import (
    RoomReport,
    SelfCalibrationParams,
    room_from_body,
)
from mocapd.calibration.record import ShirtColours
from mocapd.clock import monotonic_ns, nanoseconds, seconds
from mocapd.errors import InputError
from mocapd.geometry import rotations
from mocapd.pipeline.collector import FrameCollector
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.trackers.colour.build import colour_model, white_balance_of
from mocapd.types import Camera, Floats, Rig
from mocapd.wizard.colour.proposing import LoadDatabase
from mocapd.wizard.draft import Draft
from mocapd.wizard.only_cameras import OnlyCameras
from mocapd.wizard.saving import calibration_of
from mocapd.wizard.step import Tell

READY, SEEN = 0.1, 0.85  # shares of the job: the trackers are ready, enough is seen
_TIMEOUT_S = 0.2  # for a frame set, after which `stop` is looked at
_LONGEST_GAP_S = 0.2  # between sets that count as seen without a break
_SECTOR_RAD = np.radians(30.0)
_CELL_M = 0.3


@dataclass(frozen=True, slots=True)
class WalkParams:
    """Enough are `good_s` seen by two cameras at once, with so many facings of 30 degrees and places of
    0.3 m among them; or `longest_good_s` of anything. patience_s: in which that must be done [s]."""

    good_s: float = 20.0
    facings: int = 4
    places: int = 4
    longest_good_s: float = 30.0
    patience_s: float = 75.0
    room: SelfCalibrationParams = field(default_factory=SelfCalibrationParams)


@dataclass(frozen=True, slots=True, eq=False)
class WearerFound:
    """The room, how good it is, and where the wearer walked (N,3) [m]."""

    rig: Rig
    report: RoomReport
    walked_m: Floats


class Coverage:
    """How much of the room and of the directions was walked through, moment by moment."""

    def __init__(self, names: Sequence[str], params: WalkParams) -> None:
        self._names, self._p = tuple(names), params
        self.good_s = 0.0
        self.seen_s = dict.fromkeys(names, 0.0)  # by camera, alone or not
        self._facings: set[int] = set()
        self._places: set[tuple[int, int]] = set()
        self._last_ns: int | None = None

    def add(self, moment: Moment, t_ns: int) -> None:
        """What the cameras saw at t_ns."""
        dt_s = 0.0 if self._last_ns is None else seconds(t_ns - self._last_ns)
        self._last_ns = t_ns
        dt_s = min(dt_s, _LONGEST_GAP_S)
        for name in moment:
            self.seen_s[name] += dt_s
        if len(moment) < 2:
            return
        self.good_s += dt_s
        first = next(name for name in self._names if name in moment)
        if first != self._names[0]:
            return  # facings and places are told apart in one camera's frame only
        sighting = moment[first]
        facing = rotations.to_matrix(sighting.quats_xyzw[0])[:, 2]
        self._facings.add(int(np.arctan2(facing[0], facing[2]) // _SECTOR_RAD))
        at = sighting.joints_m[0]
        self._places.add((int(at[0] // _CELL_M), int(at[2] // _CELL_M)))

    @property
    def share(self) -> float:
        """Of what is wanted, 0..1; 1 when that is enough."""
        p = self._p
        if self.good_s >= p.longest_good_s:
            return 1.0
        return float(
            np.mean(
                [
                    min(1.0, self.good_s / p.good_s),
                    min(1.0, len(self._facings) / p.facings),
                    min(1.0, len(self._places) / p.places),
                ]
            )
        )

    @property
    def advice(self) -> str:
        """What the wearer is to do now."""
        p = self._p
        if len(self._facings) < p.facings:
            return "Walk about, move the arms, and turn a little to each side"
        if len(self._places) < p.places:
            return "Good. Step to the sides, forwards and back"
        return "Good. Go on walking and moving the arms, stretched to all sides"


@dataclass(slots=True, eq=False)
class Walk:
    """Between the job and the step: what was seen so far, and an early end."""

    seen_s: Mapping[str, float] = field(default_factory=dict)
    stop: threading.Event = field(default_factory=threading.Event)


def walk_and_solve(
    hub: FrameHub,
    draft: Draft,
    cache_dir: Path,
    walk: Walk,
    tell: Tell,
    load: LoadDatabase,
    params: WalkParams,
    clock: Callable[[], int] = monotonic_ns,
) -> WearerFound | None:
    """The room of a draft whose lenses, colours and stature are known; None when stopped.

    Raises InputError when too little was seen, ConfigError when what was seen does not agree.
    """
    assert draft.stature_m is not None
    lenses = lenses_of(draft)
    placed = replace(draft, rig=Rig(unplaced(lenses)), factors=None)
    shirt = calibration_of(placed).shirt or ShirtColours()
    colours = colour_model(shirt.model)
    W = {
        name: white_balance_of(picture, colours, plain=False)
        for name, picture in shirt.white_balance.items()
    }
    database = load(cache_dir, lambda what, share: tell(what, READY * share))
    tracks = PatchTracks(lenses, draft.stature_m, colours, W, database)
    if not _follow(
        hub, tracks, Coverage([c.name for c in lenses], params), walk, tell, params, clock
    ):
        return None
    tell("working out where the cameras stand", SEEN)
    near = draft.rig
    if near is not None and set(near.names) != {camera.name for camera in lenses}:
        near = None
    rig, report = room_from_body(tracks.moments, lenses, draft.stature_m, params.room, near)
    first = rig.cameras[0]
    walked = [
        (m[first.name].joints_m[0] - first.t_m) @ first.R for m in tracks.moments if first.name in m
    ]
    return WearerFound(rig, report, np.array(walked).reshape(-1, 3))


def lenses_of(draft: Draft) -> list[Camera]:
    """The draft's cameras with their lenses; they stand anywhere."""
    out = []
    for camera in draft.cameras:
        lens = draft.lenses[camera.id]
        out.append(Camera(camera.id, camera.size_px, lens.K, lens.dist, np.eye(3), np.zeros(3)))
    return out


def _follow(
    hub: FrameHub,
    tracks: PatchTracks,
    coverage: Coverage,
    walk: Walk,
    tell: Tell,
    params: WalkParams,
    clock: Callable[[], int],
) -> bool:
    """Follow the hub's frames until enough is seen; False when stopped. Raises InputError."""
    names = frozenset(camera.name for camera in tracks.cameras)
    collector = FrameCollector([camera.name for camera in tracks.cameras], hub.bundler)
    entry = OnlyCameras(collector, names)
    give_up_ns = clock() + nanoseconds(params.patience_s)
    hub.join(entry)
    try:
        while coverage.share < 1.0:
            if walk.stop.is_set():
                return False
            if clock() > give_up_ns:
                raise _too_little(coverage)
            frames = collector.get(_TIMEOUT_S)
            if frames is None:
                continue
            coverage.add(tracks.add(frames), frames.t_ns)
            walk.seen_s = dict(coverage.seen_s)
            tell(coverage.advice, READY + (SEEN - READY) * coverage.share)
        return True
    finally:
        hub.leave(entry)


def _too_little(coverage: Coverage) -> InputError:
    least = min(coverage.seen_s, key=lambda name: coverage.seen_s[name])
    return InputError(
        f"two cameras together saw the wearer for {coverage.good_s:.0f} s only",
        f"camera {least!r}, which saw least"
        if coverage.seen_s[least] < coverage.good_s + 5.0
        else "room",
        "check the colours, walk where all cameras see the whole shirt, and begin again",
    )
