"""The one place where a tracker is built and rehearsed, and what it keeps in the cache is made."""

import logging
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from mocapd.body.shape import BodyShape
from mocapd.calibration.calibration_record import Calibration, ShirtColours
from mocapd.clock import monotonic_ns
from mocapd.pipeline.rehearsal import rehearse
from mocapd.session.side_by_side import each_camera
from mocapd.trackers import registry
from mocapd.trackers.registry import Resources, build
from mocapd.tracking.base import Tracker
from mocapd.tracking.tracker_inputs import wearer_shape
from mocapd.tracking.tracking_state import TrackingStateParams

Progress = Callable[[str, int, int], None]  # what is being made, parts done, parts in all

_log = logging.getLogger(__name__)
_THREADS = 2  # that make what is kept in the cache


def _itself(tracker: Tracker) -> Tracker:
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
    watched: Callable[[Tracker], Tracker] = _itself,
) -> ReadyTracker:
    """The tracker of this name, ready to step. Raises ConfigError naming what it lacks.

    rehearsal: hears of steps done, in all, while the tracker is stepped through the calibration's own pictures, so
    that live frames need not wait; None for recordings, which can. watched: puts another around it that is rehearsed with it.
    """
    shape = wearer_shape(calibration)
    if rehearsal is not None:
        resources = replace(resources, now_ns=monotonic_ns)
    with _pooled(resources) as pooled:
        tracker = watched(build(name, calibration, pooled))
    if rehearsal is not None:
        shirt = calibration.shirt or ShirtColours()
        pictures = {camera: one.pixels for camera, one in shirt.white_balance.items()}
        rehearse(tracker, shape, calibration.rig, pictures, rehearsal)
    return ReadyTracker(tracker, shape)


def make_caches(name: str, cache_dir: Path, progress: Progress) -> None:
    """What this tracker keeps in the cache folder, made if need be."""
    with _pooled(cached(cache_dir, progress)) as pooled:
        registry.make_caches(name, pooled)


def cached(
    cache_dir: Path,
    progress: Progress,
    tracking: TrackingStateParams | None = None,
    params: Mapping[str, Any] | None = None,
) -> Resources:
    """With a place for what is made once, and bars while it is made; params: see Resources."""
    return Resources(
        cache_dir=cache_dir,
        progress=lambda share: progress("pose database", round(100 * share), 100),
        tracking=tracking,
        params=params or {},
    )


@contextmanager
def _pooled(resources: Resources) -> Iterator[Resources]:
    """With threads to make caches, and a log to tell of them."""
    pool = ThreadPoolExecutor(_THREADS)
    try:
        yield replace(resources, map_chunks=pool.map, warn=_log.warning, each=each_camera())
    finally:
        # who was told to end does not wait for all that is queued
        pool.shutdown(wait=False, cancel_futures=True)
