"""Builds a tracker, warms it up, and makes its caches."""

import logging
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

from mocapd.body.shape import BodyShape
from mocapd.calibration.calibration_record import Calibration, ShirtColours
from mocapd.clock import monotonic_ns
from mocapd.pipeline.rehearsal import rehearse
from mocapd.session.worker_thread import each_camera
from mocapd.trackers import registry
from mocapd.trackers.registry import Resources, build
from mocapd.tracking.base import Tracker
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.tracking.tracking_state import TrackingStateParams

Progress = Callable[[str, int, int], None]  # task, parts done, parts in all

_log = logging.getLogger(__name__)
_THREADS = 2  # that make caches


def _identity(tracker: Tracker) -> Tracker:
    return tracker


@dataclass(frozen=True, slots=True, eq=False)
class ReadyTracker:
    """A tracker, and the wearer's shape for its first step."""

    tracker: Tracker
    shape: BodyShape


def ready_tracker(
    name: str,
    calibration: Calibration,
    resources: Resources,
    rehearsal: Callable[[int, int], None] | None = None,
    watched: Callable[[Tracker], Tracker] = _identity,
) -> ReadyTracker:
    """Builds a tracker, ready to step. Raises ConfigError that names missing inputs.

    rehearsal: called with (steps done, steps in all) during a warm-up on the calibration's pictures, which spares live
    frames the delay; None for recordings. watched: wraps the tracker before the warm-up.
    """
    shape = wearer_shape(calibration)
    if rehearsal is not None:
        resources = replace(resources, now_ns=monotonic_ns)
    with _with_pool(resources) as pooled:
        tracker = watched(build(name, calibration, pooled))
    if rehearsal is not None:
        shirt = calibration.shirt or ShirtColours()
        pictures = {camera: p.pixels for camera, p in shirt.white_balance.items()}
        rehearse(tracker, shape, calibration.rig, pictures, rehearsal)
    return ReadyTracker(tracker, shape)


def make_caches(name: str, cache_dir: Path, progress: Progress, is_beginning: bool = False) -> None:
    """Makes missing caches of this tracker in the cache folder; is_beginning: the part that is made soonest."""
    resources = replace(cache_resources(cache_dir, progress), is_beginning=is_beginning)
    with _with_pool(resources) as pooled:
        registry.make_caches(name, pooled)


def cache_resources(
    cache_dir: Path,
    progress: Progress,
    tracking: TrackingStateParams | None = None,
) -> Resources:
    """Resources with a cache folder and progress bars."""
    return Resources(
        cache_dir=cache_dir,
        progress=lambda share: progress("pose database", round(100 * share), 100),
        tracking=tracking,
    )


@contextmanager
def _with_pool(resources: Resources) -> Iterator[Resources]:
    """Adds threads that make caches, and a log."""
    pool = ThreadPoolExecutor(_THREADS)
    try:
        yield replace(resources, map_chunks=pool.map, warn=_log.warning, each=each_camera())
    finally:
        # an interrupted process does not wait for queued work
        pool.shutdown(wait=False, cancel_futures=True)
