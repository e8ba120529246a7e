"""The trackers that exist: one line each in TRACKERS."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from mocapd.body.skeleton import standard_skeleton
from mocapd.calibration.record import Calibration
from mocapd.errors import ConfigError
from mocapd.trackers.base import Tracker, stature_m
from mocapd.trackers.tracking_state import TrackingStateParams

if TYPE_CHECKING:
    from mocapd.shirt.pose_database.database import PoseDatabase

MapChunks = Callable[[Callable[[slice], None], Iterable[slice]], Iterable[None]]


def _quiet(_: object) -> None:
    """Nobody watches, or nothing is to be done."""


@dataclass(frozen=True, slots=True, eq=False)
class Resources:
    """What any tracker may use, whoever is tracked.

    cache_dir: where the pose database is kept, progress(0..1) while it is made, map_chunks: `map`, or
    that of a thread pool, tell: hears a line about a cache that was made anew or cannot be kept;
    tracking: when a person counts as lost, None for the defaults.
    """

    cache_dir: Path = field(default_factory=Path)
    progress: Callable[[float], None] = _quiet
    map_chunks: MapChunks = map
    tell: Callable[[str], None] = _quiet
    tracking: TrackingStateParams | None = None


@dataclass(frozen=True, slots=True)
class TrackerEntry:
    """`build` makes the tracker in one of its variants and raises ConfigError naming what it lacks; it imports it only then.

    `sees`: whether it looks at the pictures, so that it needs calibrated cameras, and an empty room
    must give `lost`; `variants`: the first is the usual one; `make_caches`: what it keeps in the
    cache folder, made if need be.
    """

    build: Callable[[Calibration, Resources, str], Tracker]
    sees: bool
    variants: tuple[str, ...] = ("full",)
    make_caches: Callable[[Resources], object] = _quiet


def _canned(calibration: Calibration, _resources: Resources, _variant: str) -> Tracker:
    from mocapd.trackers.canned.tracker import CannedTracker

    return CannedTracker(standard_skeleton(stature_m(calibration)))


def _database(resources: Resources) -> "PoseDatabase":
    from mocapd.shirt.pose_database.database_file import FILE_NAME, load_or_build

    stale = (resources.cache_dir / FILE_NAME).exists()
    loaded = load_or_build(
        resources.cache_dir, progress=resources.progress, map_chunks=resources.map_chunks
    )
    if loaded.built and stale:
        resources.tell(f"{loaded.reason}, so it was made anew")
    if loaded.warning:
        resources.tell(loaded.warning)
    return loaded.database


def _colour(calibration: Calibration, resources: Resources, variant: str) -> Tracker:
    from mocapd.trackers.colour.build import build_colour_tracker

    return build_colour_tracker(calibration, _database(resources), variant, resources.tracking)


TRACKERS: Mapping[str, TrackerEntry] = MappingProxyType(
    {
        "canned": TrackerEntry(_canned, sees=False),
        "colour": TrackerEntry(
            _colour,
            sees=True,
            variants=("full", "paper", "paper-tolerant", "baseline", "baseline-tolerant"),
            make_caches=_database,
        ),
    }
)


def entry(name: str, variant: str = "full") -> TrackerEntry:
    """The tracker of this name. Raises ConfigError when there is none, or not in this variant."""
    if name not in TRACKERS:
        raise ConfigError(
            f"there is no tracker {name!r}", "tracker.name", f"one of: {', '.join(TRACKERS)}"
        )
    found = TRACKERS[name]
    if variant not in found.variants:
        raise ConfigError(
            f"the tracker {name!r} has no variant {variant!r}",
            "tracker.variant",
            f"one of: {', '.join(found.variants)}",
        )
    return found


def build(
    name: str, calibration: Calibration, resources: Resources, variant: str = "full"
) -> Tracker:
    """The tracker of this name. Raises ConfigError when there is none, or it is not told what it needs."""
    found = entry(name, variant)
    if found.sees and calibration.rig is None:
        raise ConfigError(
            f"the tracker {name!r} needs to know where the cameras are",
            "rig",
            "give a rig file (rig = ..., or --rig); one camera alone may go without",
        )
    return found.build(calibration, resources, variant)


def make_caches(name: str, resources: Resources) -> None:
    """What this tracker keeps in the cache folder, made if need be."""
    entry(name).make_caches(resources)
