"""The job of the extrinsics without a board: tracks the wearer in every camera alone, then solves."""

import threading
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mocapd.calibrate.self_calibration.joint_solver import SelfCalibrationReport
from mocapd.calibrate.self_calibration.patch_tracks import PatchTracks, place_nominally
from mocapd.calibrate.self_calibration.self_calibration import extrinsics_from_body
from mocapd.calibrate.self_calibration.walk_coverage import Coverage, WalkParams
from mocapd.calibration.calibration_record import ShirtColours
from mocapd.clock import monotonic_ns, nanoseconds
from mocapd.errors import InputError
from mocapd.geometry.camera_model import from_camera
from mocapd.pipeline.collector import FrameCollector
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.types import Camera, Floats, Rig
from mocapd.wizard.colour.stroke_proposals import LoadDatabase
from mocapd.wizard.draft import Draft
from mocapd.wizard.saving import calibration_of
from mocapd.wizard.step import Tell

READY, SEEN = 0.1, 0.85  # shares of the job: the trackers are ready, enough observations
_TIMEOUT_S = 0.2  # for a frame set; then `stop` is checked


@dataclass(frozen=True, slots=True, eq=False)
class WearerExtrinsics:
    """The extrinsics, their quality, and the wearer's path (N,3) [m]."""

    rig: Rig
    report: SelfCalibrationReport
    walked_m: Floats


def walk_and_solve(
    hub: FrameHub,
    draft: Draft,
    cache_dir: Path,
    stop: threading.Event,
    progress: Tell,
    load: LoadDatabase,
    params: WalkParams,
) -> WearerExtrinsics | None:
    """The extrinsics of a draft that has intrinsics, colours and stature; None when stopped.

    Raises InputError for too few observations, ConfigError for contradicting ones.
    """
    assert draft.stature_m is not None
    bare_cameras = draft_cameras(draft)
    placed = replace(draft, rig=Rig(place_nominally(bare_cameras)), factors=None)
    shirt = calibration_of(placed).shirt or ShirtColours()
    colours = colour_model(shirt.model)
    W = white_balances(shirt.white_balance, colours)
    database = load(cache_dir, lambda what, share: progress(what, READY * share))
    tracks = PatchTracks(bare_cameras, draft.stature_m, colours, W, database)
    if not _follow(
        hub, tracks, Coverage([c.name for c in bare_cameras], params), stop, progress, params
    ):
        return None
    progress("working out where the cameras stand", SEEN)
    near = draft.rig
    if near is not None and set(near.names) != {camera.name for camera in bare_cameras}:
        near = None
    rig, report = extrinsics_from_body(
        tracks.observations, bare_cameras, draft.stature_m, params.extrinsics, near
    )
    first = rig.cameras[0]
    walked = [
        from_camera(first, m[first.name].joints_m[0])
        for m in tracks.observations
        if first.name in m
    ]
    return WearerExtrinsics(rig, report, np.array(walked).reshape(-1, 3))


def draft_cameras(draft: Draft) -> list[Camera]:
    """The draft's cameras with their intrinsics, at any pose."""
    lenses = [(camera, draft.intrinsics[camera.id]) for camera in draft.cameras]
    return [
        Camera(camera.id, camera.size_px, lens.K, lens.dist, np.eye(3), np.zeros(3))
        for camera, lens in lenses
    ]


def _follow(
    hub: FrameHub,
    tracks: PatchTracks,
    coverage: Coverage,
    stop: threading.Event,
    progress: Tell,
    params: WalkParams,
) -> bool:
    """Track the hub's frames until there is enough; False when stopped. Raises InputError."""
    collector = FrameCollector([camera.name for camera in tracks.cameras], hub.bundler)
    give_up_ns = monotonic_ns() + nanoseconds(params.patience_s)
    hub.join(collector)
    try:
        while coverage.share < 1.0:
            if stop.is_set():
                return False
            if monotonic_ns() > give_up_ns:
                raise _too_little(coverage)
            frames = collector.get(_TIMEOUT_S)
            if frames is None:
                continue
            coverage.add(tracks.add(frames), frames.t_ns)
            progress(coverage.advice, READY + (SEEN - READY) * coverage.share)
        return True
    finally:
        hub.leave(collector)


def _too_little(coverage: Coverage) -> InputError:
    least = min(coverage.visible_s, key=lambda name: coverage.visible_s[name])
    return InputError(
        f"two cameras together saw the wearer for {coverage.good_s:.0f} s only",
        f"camera {least!r}, which saw least"
        if coverage.visible_s[least] < coverage.good_s + 5.0
        else "room",
        "check the colours, walk where all cameras see the whole shirt, and begin again",
    )
