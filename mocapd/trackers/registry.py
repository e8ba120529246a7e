"""The table of trackers: one entry each in TRACKERS."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from mocapd.boundary.files import is_absent, is_file
from mocapd.calibration.calibration_record import Calibration
from mocapd.each import Each, in_turn
from mocapd.errors import ConfigError
from mocapd.geometry.camera_model import sees_from_one_place
from mocapd.shirt.pose_database.cache_name import CACHE_NAME
from mocapd.tracking.base import Tracker, frozen_clock
from mocapd.tracking.tracking_state import TrackingStateParams

if TYPE_CHECKING:
    from mocapd.shirt.pose_database.database import PoseDatabase

MapChunks = Callable[[Callable[[slice], None], Iterable[slice]], Iterable[None]]


@dataclass(frozen=True, slots=True)
class Profile:
    """The cues of a body tracker."""

    shirt: bool
    clothes: bool


PROFILES: Mapping[str, Profile] = MappingProxyType(
    {
        "auto": Profile(shirt=True, clothes=True),
        "shirt": Profile(shirt=True, clothes=False),
        "markerless": Profile(shirt=False, clothes=True),
    }
)


def _quiet(_: object) -> None:
    """Does nothing."""


@dataclass(frozen=True, slots=True, eq=False)
class Resources:
    """Resources of any tracker.

    cache_dir: folder of the pose database; is_beginning: the part of it that is made soonest suffices; progress(0..1):
    called while it is built; map_chunks: `map`, or that of a thread pool; warn: gets a line about a rebuilt or
    unwritable cache, or about a cue that is left out; tracking: when a person counts as lost, None for the defaults;
    params: a tracker's parameters by its name, for studies; each: map over a tracker's cameras; now_ns: the clock for
    spreading long work over several frame sets; for recordings it stands still, because they wait.
    """

    cache_dir: Path = field(default_factory=Path)
    progress: Callable[[float], None] = _quiet
    map_chunks: MapChunks = map
    warn: Callable[[str], None] = _quiet
    tracking: TrackingStateParams | None = None
    params: Mapping[str, Any] = field(default_factory=dict)
    each: Each = in_turn
    now_ns: Callable[[], int] = frozen_clock
    is_beginning: bool = False


@dataclass(frozen=True, slots=True)
class TrackerEntry:
    """`build` makes the tracker from the calibration, its params (None: the defaults) and the resources, importing it then.

    lacks: the reason why it cannot track with this calibration and these cameras, or empty; sees: whether it uses the
    pictures, so that an empty room must give `lost`; reads_shirt: whether its evidence is the shirt's colour ids, which
    a setup measures with; reads_outline: whether it is the whole body in any clothes; whole_pictures: whether it computes on
    pictures as delivered, not on those averaged down; make_caches: makes its missing cache files; caches: their names.
    """

    build: Callable[[Calibration, Any, Resources], Tracker]
    lacks: Callable[[Calibration, Collection[str]], str]
    sees: bool
    reads_shirt: bool = False
    reads_outline: bool = False
    whole_pictures: bool = False
    make_caches: Callable[[Resources], object] = _quiet
    caches: tuple[str, ...] = ()


def _nothing_lacks(_calibration: Calibration, _cameras: Collection[str]) -> str:
    return ""


def _rig_lacks(calibration: Calibration, cameras: Collection[str]) -> str:
    """For trackers that need one calibrated camera."""
    if calibration.rig is None:
        return "needs to know where the cameras are"
    if not set(calibration.rig.names) & set(cameras):
        return f"needs one of the calibrated cameras ({', '.join(calibration.rig.names)})"
    return ""


def _pair_lacks(calibration: Calibration, cameras: Collection[str]) -> str:
    """For trackers that need two calibrated cameras in different places."""
    missing = _rig_lacks(calibration, cameras)
    if missing or calibration.rig is None:
        return missing
    seeing = [camera for camera in calibration.rig.cameras if camera.name in cameras]
    if len(seeing) < 2:
        return f"needs two of the calibrated cameras ({', '.join(calibration.rig.names)})"
    if sees_from_one_place(seeing):
        return "needs cameras in two places: by the calibration all are in one"
    return ""


def _ring_lacks(calibration: Calibration, cameras: Collection[str]) -> str:
    """For trackers by the visual hull, which needs three cameras: of two it is several times a body's volume."""
    missing = _pair_lacks(calibration, cameras)
    if missing or calibration.rig is None:
        return missing
    if len(set(calibration.rig.names) & set(cameras)) < 3:
        return f"needs three of the calibrated cameras ({', '.join(calibration.rig.names)})"
    return ""


def _build_canned(_calibration: Calibration, params: Any, _resources: Resources) -> Tracker:
    from mocapd.trackers.canned.tracker import CannedTracker

    return CannedTracker(params)


def _database(resources: Resources) -> "PoseDatabase":
    from mocapd.shirt.pose_database.database_file import load_or_build, load_or_build_beginning

    # a beginning is made when the whole is stale, which is said when that is rebuilt
    stale = not resources.is_beginning and not is_absent(resources.cache_dir / CACHE_NAME)
    load = load_or_build_beginning if resources.is_beginning else load_or_build
    loaded = load(resources.cache_dir, progress=resources.progress, map_chunks=resources.map_chunks)
    if loaded.built and stale:
        resources.warn(f"{loaded.reason}, so it was rebuilt")
    if loaded.warning:
        resources.warn(loaded.warning)
    return loaded.database


def _lacks(name: str, calibration: Calibration, cameras: Collection[str]) -> Mapping[str, str]:
    """For each cue of this profile that the wearer may have: the reason why it cannot track, or empty."""
    profile = PROFILES[name]
    lacking = {}
    if profile.shirt and (calibration.wearer.has_shirt or not profile.clothes):
        lacking["shirt"] = _rig_lacks(calibration, cameras)
    if profile.clothes:
        lacking["clothes"] = _pair_lacks(calibration, cameras)
    return lacking


def _profile(name: str) -> TrackerEntry:
    """The entry of a body tracker, which needs at least one of its cues."""
    profile = PROFILES[name]

    def lacks(calibration: Calibration, cameras: Collection[str]) -> str:
        missing = list(_lacks(name, calibration, cameras).values())
        return missing[0] if all(missing) else ""

    def build_it(calibration: Calibration, params: Any, resources: Resources) -> Tracker:
        from mocapd.tracking.build import build_body_tracker

        cameras = calibration.rig.names if calibration.rig else ()
        lacking = _lacks(name, calibration, cameras)
        if lacking.get("clothes") and "shirt" in lacking and len(cameras) > 1:
            resources.warn(
                f"only somebody in the shirt is tracked: the cue 'clothes' {lacking['clothes']}"
            )
        shirt = "shirt" in lacking and (not lacking["shirt"] or "clothes" not in lacking)
        # below the shirt it follows legs and head with one camera, too, if it knows where the floor is
        clothes = "clothes" in lacking and (
            not lacking["clothes"] or not shirt or not calibration.assumes_rig
        )
        return build_body_tracker(
            name, calibration, _database(resources) if shirt else None, clothes, params, resources.tracking,
            resources.each, resources.now_ns,
        )  # fmt: skip

    return TrackerEntry(
        build_it,
        lacks,
        sees=True,
        reads_shirt=profile.shirt and not profile.clothes,
        reads_outline=profile.clothes and not profile.shirt,
        make_caches=_database if profile.shirt else _quiet,
        caches=(CACHE_NAME,) if profile.shirt else (),
    )


def _wang2011(calibration: Calibration, params: Any, resources: Resources) -> Tracker:
    from mocapd.published.wang2011.build import build_wang2011_tracker

    return build_wang2011_tracker(calibration, _database(resources), params, resources.tracking)


def _hecht2009(calibration: Calibration, params: Any, resources: Resources) -> Tracker:
    from mocapd.published.hecht2009.tracker import Hecht2009Tracker
    from mocapd.tracking.tracker_inputs import calibrated_rig, stature_m

    rig, stature = calibrated_rig(calibration), stature_m(calibration)
    return Hecht2009Tracker(rig, stature, params, resources.tracking)


def _rao_hodges(calibration: Calibration, params: Any, resources: Resources) -> Tracker:
    from mocapd.published.rao_hodges.tracker import RaoHodgesTracker
    from mocapd.tracking.tracker_inputs import calibrated_rig, stature_m

    rig, stature = calibrated_rig(calibration), stature_m(calibration)
    return RaoHodgesTracker(rig, stature, params, resources.tracking)


TRACKERS: Mapping[str, TrackerEntry] = MappingProxyType(
    {
        "auto": _profile("auto"),
        "canned": TrackerEntry(_build_canned, _nothing_lacks, sees=False),
        "shirt": _profile("shirt"),
        "markerless": _profile("markerless"),
        "hecht2009": TrackerEntry(
            _hecht2009,
            _pair_lacks,
            sees=True,
            whole_pictures=True,
        ),
        "rao_hodges": TrackerEntry(
            _rao_hodges,
            _ring_lacks,
            sees=True,
        ),
        "wang2011": TrackerEntry(
            _wang2011,
            _rig_lacks,
            sees=True,
            reads_shirt=True,
            whole_pictures=True,
            make_caches=_database,
            caches=(CACHE_NAME,),
        ),
    }
)

# Names of earlier versions, accepted for one release: the configuration puts the present name in their place.
RENAMED: Mapping[str, str] = MappingProxyType(
    {
        "colour": "shirt",
        "flex": "markerless",
        "colour_paper": "wang2011",
        "flex_paper": "hecht2009",
    }
)


def entry(name: str) -> TrackerEntry:
    """The tracker of this name. Raises ConfigError when there is none."""
    if name not in TRACKERS:
        raise ConfigError(
            f"there is no tracker {name!r}", "tracker.name", f"one of: {', '.join(TRACKERS)}"
        )
    return TRACKERS[name]


def measuring_tracker(preferred: str, has_shirt: bool) -> str:
    """The tracker for checking a setup: by the shirt, or without one by the whole body."""
    if has_shirt:
        return shirt_tracker(preferred)
    if entry(preferred).reads_outline:
        return preferred
    return next(name for name, tracker in TRACKERS.items() if tracker.reads_outline)


def shirt_tracker(preferred: str) -> str:
    """The preferred tracker if it reads the shirt, else the first that does: a setup's measurements need it."""
    if entry(preferred).reads_shirt:
        return preferred
    return next(name for name, tracker in TRACKERS.items() if tracker.reads_shirt)


def require_calibration(name: str, calibration: Calibration) -> None:
    """Raises ConfigError if this tracker cannot track with the calibration."""
    reason = entry(name).lacks(calibration, calibration.rig.names if calibration.rig else ())
    if reason:
        raise ConfigError(
            f"the tracker {name!r} {reason}",
            "rig",
            "give a rig file (rig = ..., or --rig); one camera alone may go without",
        )


def build(name: str, calibration: Calibration, resources: Resources) -> Tracker:
    """The tracker of this name. Raises ConfigError for an unknown name or an insufficient calibration."""
    require_calibration(name, calibration)
    return entry(name).build(calibration, resources.params.get(name), resources)


def make_caches(name: str, resources: Resources) -> None:
    """Make this tracker's missing cache files."""
    entry(name).make_caches(resources)


def has_caches(name: str, cache_dir: Path) -> bool:
    """True if all of this tracker's cache files exist; only `make_caches` checks that they are current."""
    return all(is_file(cache_dir / file_name) for file_name in entry(name).caches)
