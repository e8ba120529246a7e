"""The sets of recordings: which tracker follows them, which joints are scored, and how often each is tracked."""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from lab.simulated import recorded_set
from lab.simulated.failure_scenes import standing_sessions
from lab.simulated.session_plan import PlannedSession
from mocapd.errors import InputError
from mocapd.evaluate.capture_eval import Case, open_case
from mocapd.session.tracker_setup import Progress

_KEY = re.compile(r"-[0-9a-f]{12}$")
SETS = (
    "dev", "half_rate", "shirt", "one_camera", "plain", "rings", "failures", "interruptions", "rest",
)  # fmt: skip
_NO_SHIRT = ("plain", "striped")  # in the name of a capture
_SCORED_WHOLE = ("stereo_", "ring4_")  # captures of the whole body


@dataclass(frozen=True, slots=True, eq=False)
class GateCase:
    """One recording of a set. joints: which are scored; by_chance: whether runs that hardly differ end apart, so that it
    is tracked several times; still_from_s: from then on nobody moves, None for a recording of motion; camera: the index
    of the only one that is used, None for all; every: of the frame sets one of so many is shown, as a slower camera would.
    """

    set_name: str
    case: Case
    joints: str
    by_chance: bool = True
    still_from_s: float | None = None
    camera: int | None = None
    every: int = 1

    @property
    def name(self) -> str:
        """Of its row: that of the recording, without the key of the code that drew it, so that sets are compared that two
        versions of the simulator drew."""
        return _KEY.sub("", self.case.name)


def cases_of(
    names: tuple[str, ...], clips: Path, captures: Path, cache_dir: Path, progress: Progress
) -> Iterator[GateCase]:
    """The recordings of these sets, those that are simulated made if need be. Raises InputError."""
    makers: dict[str, Callable[[], Iterator[GateCase]]] = {
        "dev": lambda: _dev(captures),
        "half_rate": lambda: map(_at_half_rate, _dev(captures)),
        "shirt": lambda: _simulated("shirt", recorded_set.planned(clips), cache_dir, progress),
        "one_camera": lambda: _one_camera(captures, clips, cache_dir, progress),
        "plain": lambda: _simulated(
            "plain", recorded_set.planned(clips, "plain"), cache_dir, progress
        ),
        "rings": lambda: _simulated(
            "rings", recorded_set.planned(clips, "rings"), cache_dir, progress
        ),
        "failures": lambda: _simulated(
            "failures", recorded_set.failures()[:-1], cache_dir, progress
        ),
        "interruptions": lambda: _simulated(
            "interruptions", [recorded_set.interrupted()], cache_dir, progress
        ),
        "rest": lambda: _still(cache_dir, progress),
    }
    for name in names:
        if name not in makers:
            raise InputError(f"there is no set {name!r}", "--sets", f"some of: {', '.join(SETS)}")
        yield from makers[name]()


def _dev(captures: Path) -> Iterator[GateCase]:
    folders = sorted(path.parent for path in captures.glob("*/rig.json"))
    if not folders:
        raise InputError("holds no capture", str(captures), "give the folder with --captures")
    for folder in folders:
        joints = "full" if folder.name.startswith(_SCORED_WHOLE) else "upper"
        yield GateCase("dev", open_case(folder), joints)


def _at_half_rate(one: GateCase) -> GateCase:
    truth = one.case.truth
    thinned = replace(
        truth,
        times_s=truth.times_s[::2],
        joints_m=truth.joints_m[::2],
        visible=truth.visible[::2],
    )
    return replace(one, set_name="half_rate", every=2, case=replace(one.case, truth=thinned))


def _one_camera(
    captures: Path, clips: Path, cache_dir: Path, progress: Progress
) -> Iterator[GateCase]:
    """Everybody in the shirt as one camera sees him: the first, second, ... of a recording in turn."""
    shirts = [
        *(one for one in _dev(captures) if not any(word in one.name for word in _NO_SHIRT)),
        *_simulated("shirt", recorded_set.planned(clips), cache_dir, progress),
    ]
    for number, one in enumerate(shirts):
        camera = number % len(one.case.folder.cameras)
        yield replace(one, set_name="one_camera", camera=camera, by_chance=True)


def _simulated(
    name: str,
    sessions: list[PlannedSession],
    cache_dir: Path,
    progress: Progress,
) -> Iterator[GateCase]:
    for session in sessions:
        (folder,) = recorded_set.recorded([session], cache_dir, progress)
        joints = "full" if session.scenario.body.whole else "upper"
        yield GateCase(name, open_case(folder), joints, by_chance=name != "shirt")


def _still(cache_dir: Path, progress: Progress) -> Iterator[GateCase]:
    for session, still_from_s in standing_sessions(recorded_set.first_scene()):
        (folder,) = recorded_set.recorded([session], cache_dir, progress)
        yield GateCase("rest", open_case(folder), "full", still_from_s=still_from_s)
