"""The trackers that exist: one line each in TRACKERS."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING

from mocapd.body.skeleton import standard_skeleton
from mocapd.errors import ConfigError
from mocapd.trackers.base import Tracker
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.types import Floats, LabelledPicture, Rig

if TYPE_CHECKING:
    from mocapd.shirt.pose_database.database import PoseDatabase

MapChunks = Callable[[Callable[[slice], None], Iterable[slice]], Iterable[None]]


def _quiet(_: object) -> None:
    """Nobody watches, or nothing is to be done."""


@dataclass(frozen=True, slots=True, eq=False)
class TrackerInputs:
    """What may be known before the first frame; a tracker refuses what it needs and is not given.

    stature_m: the wearer's height [m]; model: the shirt in neutral light; white_balance: by camera,
    the shirt in the place's own light; variant: one of the tracker's; cache_dir: where the pose
    database is kept, progress(0..1) while it is made, map_chunks: `map`, or that of a thread pool,
    tell: hears a line about a cache that was made anew or cannot be kept; tracking: when a person
    counts as lost, None for the defaults; factors (N_FACTORS,): the wearer's proportions as measured,
    None for the mean body's.
    """

    rig: Rig | None
    stature_m: float
    model: tuple[LabelledPicture, ...] = ()
    white_balance: Mapping[str, LabelledPicture] = field(default_factory=dict)
    variant: str = "full"
    cache_dir: Path = field(default_factory=Path)
    progress: Callable[[float], None] = _quiet
    map_chunks: MapChunks = map
    tell: Callable[[str], None] = _quiet
    tracking: TrackingStateParams | None = None
    factors: Floats | None = None


@dataclass(frozen=True, slots=True)
class TrackerEntry:
    """`build` makes the tracker and raises ConfigError naming what it lacks; it imports it only then.

    `sees`: whether it looks at the pictures, so that it needs calibrated cameras, and an empty room
    must give `lost`; `variants`: the first is the usual one; `make_caches`: what it keeps in the
    cache folder, made if need be.
    """

    build: Callable[[TrackerInputs], Tracker]
    sees: bool
    variants: tuple[str, ...] = ("full",)
    make_caches: Callable[[TrackerInputs], object] = _quiet


def _canned(inputs: TrackerInputs) -> Tracker:
    from mocapd.trackers.canned.tracker import CannedTracker

    return CannedTracker(standard_skeleton(inputs.stature_m))


def _database(inputs: TrackerInputs) -> "PoseDatabase":
    from mocapd.shirt.pose_database.database_file import FILE_NAME, load_or_build

    stale = (inputs.cache_dir / FILE_NAME).exists()
    loaded = load_or_build(inputs.cache_dir, progress=inputs.progress, map_chunks=inputs.map_chunks)
    if loaded.built and stale:
        inputs.tell(f"{loaded.reason}, so it was made anew")
    if loaded.warning:
        inputs.tell(loaded.warning)
    return loaded.database


def _colour(inputs: TrackerInputs) -> Tracker:
    from mocapd.trackers.colour.build import build_colour_tracker

    return build_colour_tracker(
        inputs.rig,
        inputs.stature_m,
        inputs.model,
        inputs.white_balance,
        _database(inputs),
        inputs.variant,
        inputs.tracking,
        inputs.factors,
    )


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


def build(name: str, inputs: TrackerInputs) -> Tracker:
    """The tracker of this name. Raises ConfigError when there is none, or it lacks an input."""
    found = entry(name, inputs.variant)
    if found.sees and inputs.rig is None:
        raise ConfigError(
            f"the tracker {name!r} needs to know where the cameras are",
            "rig",
            "give a rig file (rig = ..., or --rig); one camera alone may go without",
        )
    return found.build(inputs)


def make_caches(name: str, inputs: TrackerInputs) -> None:
    """What this tracker keeps in the cache folder, made if need be; the rig is not asked for."""
    entry(name, inputs.variant).make_caches(inputs)
