"""Persists a setup in progress beyond its process: writes it after each result, and offers it at the next start.

Its file is a partial `calibration.toml` in a folder of its own. Only its user may read it, as pictures show the wearer; it
has no passwords of cameras.
"""

import logging
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from mocapd.boundary.files import MissingError
from mocapd.boundary.urls import without_password
from mocapd.calibration.calibration_file import MOST_SETUP_BYTES, read_tables
from mocapd.calibration.calibration_writing import remove_setup, write_setup
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.errors import CannotCreateError, InputError, MalformedError, MocapdError, NewerFileError
from mocapd.quarantine import Why, quarantine
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.draft import Draft, DraftCamera, with_cameras
from mocapd.wizard.saving import draft_of, setup_of
from mocapd.wizard.step_names import StepName

FILE_NAME = "setup/calibration.toml"  # in the state directory
OF_EARLIER_VERSIONS = "setup-draft.msgpack"
FORGOTTEN = timedelta(days=7)  # rooms and lights have changed by then

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class UnfinishedSetup:
    """when: time of writing (UTC); done: steps with their result in the draft. The cameras' sources lack
    passwords."""

    when: datetime
    done: frozenset[StepName]
    draft: Draft


class SetupKeeper:
    """Made by the host for one setup of all steps; used by the wizard's thread.

    Until the user chooses `resume` or `discard`, the file of an unfinished setup stays unchanged.
    """

    def __init__(
        self,
        state_dir: Path,
        begun: Draft,
        locks: CameraLocks,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
    ) -> None:
        """begun: the setup's initial draft; its cameras are the open ones."""
        self._path = state_dir / FILE_NAME
        self._opened, self._locks, self._now = begun.cameras, locks, now
        self._begun = begun
        self._wanted: tuple[Draft, frozenset[StepName]] = begun, frozenset()
        self._written = self._wanted
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="setup-keeper")
        self._writing: Future[None] | None = None
        self._trouble = ""
        self.offer = self._found()
        """The unfinished setup, before the user's choice."""

    # -- the choice ------------------------------------------------------------------------------

    def resume(self) -> UnfinishedSetup:
        """The unfinished setup, with its controls set in the cameras. Raises InputError without one."""
        unfinished, self.offer = self._require_offer(), None
        opened = {camera.id: camera for camera in self._opened}
        there = tuple(replace(c, source=opened[c.id].source) for c in unfinished.draft.cameras)
        draft = replace(unfinished.draft, cameras=there)
        draft = with_cameras(draft, tuple(self._as_open(c, opened[c.id]) for c in there))
        self._begun = Draft()  # all of it is news
        self._wanted = self._written = draft, unfinished.done
        return replace(unfinished, draft=draft)

    def discard(self) -> None:
        """Remove the unfinished setup. Raises InputError without one."""
        self._require_offer()
        self.offer = None
        self._remove()

    def _require_offer(self) -> UnfinishedSetup:
        if self.offer is None:
            raise InputError("there is no unfinished setup", "the page", "reload the page")
        return self.offer

    def _as_open(self, camera: DraftCamera, opened: DraftCamera) -> DraftCamera:
        """Set a webcam to the unfinished setup's controls, as far as it accepts them."""
        if not self._locks.can_lock(camera.id):
            return replace(camera, size_px=opened.size_px, fps_hz=opened.fps_hz)
        self._locks.take_up(
            camera.id, WebcamSettings(camera.size_px, camera.fps_hz, camera.controls)
        )
        return camera

    # -- keeping ---------------------------------------------------------------------------------

    def keep(self, draft: Draft, done: frozenset[StepName]) -> None:
        """Write the present state in another thread, if a step has a new result."""
        if self.offer is None:
            self._wanted = draft, done
            self._write_on()

    def on_saved(self, draft: Draft) -> None:
        """Called after saving the draft as the calibration."""
        self._wait()
        self._begun = draft
        self._wanted = self._written = draft, self._wanted[1]
        if self.offer is None:
            self._remove()

    def close(self) -> None:
        """Returns when all is written."""
        self._wait()
        self._write_on()
        self._wait()
        self._worker.shutdown()

    def _write_on(self) -> None:
        if self._writing is not None:
            if not self._writing.done():
                return  # a later write takes the newest state
            self._wait()
        (draft, done), (before, done_before) = self._wanted, self._written
        if draft is before and done == done_before:
            return
        self._written = self._wanted
        if has_news(draft, self._begun):
            self._writing = self._worker.submit(
                self._write, UnfinishedSetup(self._now(), done, draft)
            )

    def _wait(self) -> None:
        writing, self._writing = self._writing, None
        if writing is not None:
            writing.result()  # raises unexpected exceptions

    def _write(self, unfinished: UnfinishedSetup) -> None:
        try:
            write_draft(self._path, unfinished)
        except CannotCreateError as error:
            if str(error) != self._trouble:
                self._trouble = str(error)
                _log.warning("the setup in progress cannot be stored: %s", error)

    def _remove(self) -> None:
        with suppress(OSError):  # then the next start offers it again
            remove_setup(self._path)

    # -- what there is ---------------------------------------------------------------------------

    def _found(self) -> UnfinishedSetup | None:
        earlier = self._path.parents[1] / OF_EARLIER_VERSIONS
        if earlier.exists():
            _log.warning(
                "%s: a setup in progress of an earlier mocapd: go on with that version, or remove the file",
                earlier,
            )
        unfinished: UnfinishedSetup | None = None
        try:
            unfinished = read_draft(self._path)
            why_not = self._why_not(unfinished)
        except MissingError:
            return None
        except MocapdError as error:
            self._quarantine(error)
            return None
        if why_not:
            _log.info("%s: the unfinished setup is removed: %s", self._path, why_not)
            self._remove()
            return None
        return unfinished

    def _quarantine(self, error: MocapdError) -> None:
        """Move an unreadable file away, as another mocapd may still use it."""
        with suppress(OSError):  # then the next start tries again
            why: Why = "newer" if isinstance(error, NewerFileError) else "corrupt"
            moved_to = quarantine(self._path, why)
            _log.warning(
                "%s: the unfinished setup cannot be used (%s), and is now %s",
                *(self._path, error.what, moved_to.name),
            )

    def _why_not(self, unfinished: UnfinishedSetup) -> str:
        """Why it is not offered; empty when it is."""
        opened = {camera.id: without_password(camera.source) for camera in self._opened}
        if self._now() - unfinished.when > FORGOTTEN:
            return f"it is of {unfinished.when:%Y-%m-%d}"
        if any(opened.get(camera.id) != camera.source for camera in unfinished.draft.cameras):
            return "it is of other cameras"
        return ""


def unfinished_cameras(state_dir: Path, saved: Sequence[DraftCamera]) -> tuple[DraftCamera, ...]:
    """The cameras of the unfinished setup, then other saved ones: with the names and modes to open them
    in."""
    try:
        unfinished = read_draft(state_dir / FILE_NAME).draft.cameras
    except MocapdError:  # none, or one that is not offered
        return tuple(saved)
    ids, sources = {camera.id for camera in unfinished}, {camera.source for camera in unfinished}
    rest = (camera for camera in saved if camera.id not in ids and camera.source not in sources)
    return (*unfinished, *rest)


def has_news(draft: Draft, begun: Draft) -> bool:
    """Whether a step after Cameras has a new result."""
    return (
        draft.board not in (None, begun.board)
        or draft.stature_m not in (None, begun.stature_m)
        or any(
            one is not None and one is not before
            for one, before in ((draft.rig, begun.rig), (draft.factors, begun.factors))
        )
        or any(
            intrinsics is not begun.intrinsics.get(name)
            for name, intrinsics in draft.intrinsics.items()
        )
        or any(colours is not begun.colours.get(name) for name, colours in draft.colours.items())
    )


def write_draft(path: Path, unfinished: UnfinishedSetup) -> None:
    """Write it atomically, readable by its user alone. Raises CannotCreateError."""
    write_setup(path, *setup_of(unfinished.draft, unfinished.when, unfinished.done))


def read_draft(path: Path) -> UnfinishedSetup:
    """Raises MissingError without a file, InputError, MalformedError or ConfigError for a damaged one, NewerFileError."""
    saved = read_tables(path, MOST_SETUP_BYTES)
    if saved.setup is None:
        raise MalformedError("is of a setup that was finished")
    try:
        done = frozenset(map(StepName, saved.setup.done))
    except ValueError as error:
        raise MalformedError(f"names a step that does not exist ({error})") from None
    return UnfinishedSetup(saved.made.when, done, draft_of(saved, path))
