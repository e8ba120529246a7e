"""The trackers that exist: one line each in TRACKERS."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType

from mocapd.body.skeleton import standard_skeleton
from mocapd.errors import ConfigError
from mocapd.trackers.base import Tracker
from mocapd.trackers.tracking_state import TrackingStateParams
from mocapd.types import Bytes, Rig


@dataclass(frozen=True, slots=True, eq=False)
class StrokedPicture:
    """pixels (h,w,3) BGR and strokes (h,w): 0 none, 1.. the shirt's colour ids."""

    pixels: Bytes
    strokes: Bytes


def _quiet(_: float) -> None:
    """Nobody watches."""


@dataclass(frozen=True, slots=True, eq=False)
class TrackerInputs:
    """What may be known before the first frame; a tracker refuses what it needs and is not given.

    stature_m: the wearer's height [m]; model: the shirt in neutral light; white_balance: by camera,
    the shirt in the place's own light; variant: `full`, or `paper` for the method as published;
    cache_dir: where the pose database is kept, progress(0..1) while it is made; tracking: when a
    person counts as lost, None for the defaults.
    """

    rig: Rig | None
    stature_m: float
    model: tuple[StrokedPicture, ...] = ()
    white_balance: Mapping[str, StrokedPicture] = field(default_factory=dict)
    variant: str = "full"
    cache_dir: Path = field(default_factory=Path)
    progress: Callable[[float], None] = _quiet
    tracking: TrackingStateParams | None = None


@dataclass(frozen=True, slots=True)
class TrackerEntry:
    """`build` makes the tracker and raises ConfigError naming what it lacks; it imports it only then.

    `sees`: whether it looks at the pictures, so that an empty room must give `lost`.
    """

    build: Callable[[TrackerInputs], Tracker]
    sees: bool


def _canned(inputs: TrackerInputs) -> Tracker:
    from mocapd.trackers.canned.tracker import CannedTracker

    return CannedTracker(standard_skeleton(inputs.stature_m))


def _colour(inputs: TrackerInputs) -> Tracker:
    from mocapd.trackers.colour.build import build_colour_tracker
    from mocapd.trackers.colour.database_file import load_or_build

    database = load_or_build(inputs.cache_dir, progress=inputs.progress).database
    return build_colour_tracker(
        inputs.rig,
        inputs.stature_m,
        inputs.model,
        inputs.white_balance,
        database,
        inputs.variant,
        inputs.tracking,
    )


TRACKERS: Mapping[str, TrackerEntry] = MappingProxyType(
    {
        "canned": TrackerEntry(_canned, sees=False),
        "colour": TrackerEntry(_colour, sees=True),
    }
)


def build(name: str, inputs: TrackerInputs) -> Tracker:
    """The tracker of this name. Raises ConfigError when there is none, or it lacks an input."""
    if name not in TRACKERS:
        raise ConfigError(
            f"there is no tracker {name!r}", "tracker.name", f"one of: {', '.join(TRACKERS)}"
        )
    return TRACKERS[name].build(inputs)
