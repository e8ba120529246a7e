"""The planned sessions as captures on disk: recorded once, kept in the cache."""

import hashlib
import shutil
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import MappingProxyType

from lab.simulated.export import export_capture
from lab.simulated.failure_scenes import failure_sessions
from lab.simulated.motion_clip import MotionClip, performed, read_clip
from lab.simulated.plain_plan import plain_plan
from lab.simulated.ring_plan import ring_plan
from lab.simulated.session_plan import PlannedSession, plan
from mocapd.assets import asset_path
from mocapd.errors import ConfigError, InputError, creation_errors
from mocapd.file_lock import one_at_a_time
from mocapd.session.tracker_setup import Progress
from mocapd.sim.film import film_key
from mocapd.sim.scenario import Scenario, load_scenario
from mocapd.trackers.registry import TRACKERS, entry

SCENES = ("living_room", "outdoor", "gym_mono")


Plan = Callable[[Sequence[MotionClip], Sequence[Scenario]], list[PlannedSession]]
PLANS: Mapping[str, Plan] = MappingProxyType(
    {"shirt": plan, "plain": plain_plan, "rings": ring_plan}
)


def planned(clips: Path, name: str = "shirt") -> list[PlannedSession]:
    """The sessions of a folder of clips by the plan of this name in PLANS. Raises InputError when there is none that can be
    used."""
    paths = sorted(clips.glob("[!.]*.npz")) if clips.is_dir() else []
    scenes = [load_scenario(asset_path("scenarios") / f"{name}.toml") for name in SCENES]
    sessions = PLANS[name]([read_clip(path) for path in paths], scenes)
    if not sessions:
        raise InputError(
            "has no clip of motion (*.npz) that is long enough and stays in one place",
            str(clips),
            "give a folder of clips of motion",
        )
    return sessions


def failures() -> list[PlannedSession]:
    """The scenes for the known failures, in the first of the rooms."""
    return failure_sessions(first_scene())


def first_scene() -> Scenario:
    return load_scenario(asset_path("scenarios") / f"{SCENES[0]}.toml")


def interrupted() -> PlannedSession:
    """The last of those scenes: everything that goes wrong around somebody in the shirt."""
    return failures()[-1]


def recorded(sessions: list[PlannedSession], cache_dir: Path, progress: Progress) -> list[Path]:
    """A folder in the capture format for each session; those that are there already are not recorded anew.

    Raises CannotCreateError.
    """
    folder, out = cache_dir / "simulated", list[Path]()
    for session in sessions:
        with one_at_a_time(folder, f"{session.name}.lock"):  # another gate may record it, too
            out.append(_recorded(session, folder, progress))
    return out


def check_suits(tracker: str, sessions: list[PlannedSession], recordings: list[Path]) -> None:
    """Raises ConfigError when a tracker of this name follows the shirt, and somebody in the sessions wears none."""
    plain = [
        folder
        for one, folder in zip(sessions, recordings, strict=True)
        if one.scenario.clothes.shirt == "plain"
    ]
    if not plain or not entry(tracker).reads_shirt:
        return
    suited = [name for name, one in TRACKERS.items() if one.sees and not one.reads_shirt]
    raise ConfigError(
        f"the tracker {tracker!r} follows the shirt, which nobody wears in {len(plain)} of the sessions",
        str(plain[0].parent),
        f"add --tracker {' or '.join(suited)}"
        if suited
        else "the recordings are kept there; no tracker that needs no shirt is there yet",
    )


def _recorded(session: PlannedSession, folder: Path, progress: Progress) -> Path:
    path = folder / f"{session.name}-{_key(session)}"
    if path.is_dir():
        return path
    partial = path.with_name(f".{path.name}.partial")
    shutil.rmtree(partial, ignore_errors=True)  # of a run that was ended
    with creation_errors(partial, "set another cache_dir", "cannot be made"):
        partial.mkdir(parents=True)

    def told(done: int, of: int) -> None:
        progress(f"recording {session.name}", done, of)

    act = performed(session.clip, session.where) if session.clip and session.where else None
    notes = {} if session.clear_s is None else {"clear_s": session.clear_s}
    export_capture(session.scenario, partial, session.scenario.loop_s, told, act, notes)
    partial.rename(path)
    return path


def _key(session: PlannedSession) -> str:
    """Of everything that its pictures follow from."""
    digest = hashlib.sha256(film_key(session.scenario).encode())
    if session.clip is not None:
        digest.update(session.clip.hips_m.tobytes())
        digest.update(session.clip.global_xyzw.tobytes())
    digest.update(repr((session.where, session.clear_s)).encode())
    return digest.hexdigest()[:12]
