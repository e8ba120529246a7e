"""Keeps a setup in progress through the end of its process: written as it goes, offered at the next one."""

import logging
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

from mocapd.boundary.files import MissingError
from mocapd.boundary.urls import without_password
from mocapd.calibration.calibration_writing import remove_setup
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.errors import CannotCreateError, InputError, MocapdError, NewerFileError
from mocapd.quarantine import Why, quarantine
from mocapd.wizard.cameras.camera_draft import with_cameras
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.draft import Draft, DraftCamera
from mocapd.wizard.draft_file import (
    FILE_NAME,
    OF_EARLIER_VERSIONS,
    KeptSetup,
    read_draft,
    write_draft,
)
from mocapd.wizard.step_names import StepName

FORGOTTEN = timedelta(days=7)  # rooms and lights are others by then

_log = logging.getLogger(__name__)


class SetupKeeper:
    """Made by the host for one setup of all steps; used by the wizard's thread.

    What was kept stays in the file, and nothing is written, until the person has chosen: `resume` or
    `begin_anew`.
    """

    def __init__(
        self,
        state_dir: Path,
        begun: Draft,
        locks: CameraLocks,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
    ) -> None:
        """begun: what the setup begins with; its cameras are those that are open."""
        self._path = state_dir / FILE_NAME
        self._opened, self._locks, self._now = begun.cameras, locks, now
        self._begun = begun
        self._wanted: tuple[Draft, frozenset[StepName]] = begun, frozenset()
        self._written = self._wanted
        self._worker = ThreadPoolExecutor(1, thread_name_prefix="setup-keeper")
        self._writing: Future[None] | None = None
        self._trouble = ""
        self.offer = self._found()
        """What was kept and is not answered yet."""

    # -- the choice ------------------------------------------------------------------------------

    def resume(self) -> KeptSetup:
        """The setup that was kept, with the cameras set as it found them. Raises InputError without one."""
        kept, self.offer = self._offered(), None
        opened = {one.id: one for one in self._opened}
        there = tuple(replace(c, source=opened[c.id].source) for c in kept.draft.cameras)
        draft = replace(kept.draft, cameras=there)
        draft = with_cameras(draft, tuple(self._as_open(c, opened[c.id]) for c in there))
        self._begun = Draft()  # all of it is news
        self._wanted = self._written = draft, kept.done
        return replace(kept, draft=draft)

    def begin_anew(self) -> None:
        """The person does not want what was kept. Raises InputError when nothing was."""
        self._offered()
        self.offer = None
        self._remove()

    def _offered(self) -> KeptSetup:
        if self.offer is None:
            raise InputError("no setup of before is kept", "the page", "reload the page")
        return self.offer

    def _as_open(self, camera: DraftCamera, opened: DraftCamera) -> DraftCamera:
        """A webcam is set to what was found; what cannot be set stays as it is."""
        if not self._locks.can_lock(camera.id):
            return replace(camera, size_px=opened.size_px, fps_hz=opened.fps_hz)
        self._locks.take_up(
            camera.id, WebcamSettings(camera.size_px, camera.fps_hz, camera.controls)
        )
        return camera

    # -- keeping ---------------------------------------------------------------------------------

    def keep(self, draft: Draft, done: frozenset[StepName]) -> None:
        """What is known now: written, beside the caller, when a step has found something."""
        if self.offer is None:
            self._wanted = draft, done
            self._write_on()

    def saved(self, draft: Draft) -> None:
        """All of it is in the calibration now."""
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
                return  # what is newest by then is written next
            self._wait()
        (draft, done), (before, done_before) = self._wanted, self._written
        if draft is before and done == done_before:
            return
        self._written = self._wanted
        if has_news(draft, self._begun):
            self._writing = self._worker.submit(self._write, KeptSetup(self._now(), done, draft))

    def _wait(self) -> None:
        writing, self._writing = self._writing, None
        if writing is not None:
            writing.result()  # a bug of ours is heard of

    def _write(self, kept: KeptSetup) -> None:
        try:
            write_draft(self._path, kept)
        except CannotCreateError as error:
            if str(error) != self._trouble:
                self._trouble = str(error)
                _log.warning("the setup in progress is not kept: %s", error)

    def _remove(self) -> None:
        with suppress(OSError):  # it is asked about again then
            remove_setup(self._path)

    # -- what there is ---------------------------------------------------------------------------

    def _found(self) -> KeptSetup | None:
        earlier = self._path.parents[1] / OF_EARLIER_VERSIONS
        if earlier.exists():
            _log.warning(
                "%s: a setup in progress of an earlier mocapd: go on with that version, or remove the file",
                earlier,
            )
        kept: KeptSetup | None = None
        try:
            kept = read_draft(self._path)
            why_not = self._why_not(kept)
        except MissingError:
            return None
        except MocapdError as error:
            self._put_aside(error)
            return None
        if why_not:
            _log.info("%s: the setup that was kept there is removed: %s", self._path, why_not)
            self._remove()
            return None
        return kept

    def _put_aside(self, error: MocapdError) -> None:
        """It cannot be read: whoever made it may still want it."""
        with suppress(OSError):  # it is met again then
            why: Why = "newer" if isinstance(error, NewerFileError) else "corrupt"
            aside = quarantine(self._path, why)
            _log.warning(
                "%s: the setup that was kept there cannot be used (%s), and is kept as %s",
                *(self._path, error.what, aside.name),
            )

    def _why_not(self, kept: KeptSetup) -> str:
        """Why it is not offered; empty when it is."""
        opened = {one.id: without_password(one.source) for one in self._opened}
        if self._now() - kept.when > FORGOTTEN:
            return f"it is of {kept.when:%Y-%m-%d}"
        if any(opened.get(one.id) != one.source for one in kept.draft.cameras):
            return "it is of other cameras"
        return ""


def kept_cameras(state_dir: Path, saved: Sequence[DraftCamera]) -> tuple[DraftCamera, ...]:
    """The cameras of the setup that is kept, then those saved that are not among them: to open each under
    the name and in the mode that it had."""
    try:
        kept = read_draft(state_dir / FILE_NAME).draft.cameras
    except MocapdError:  # none, or one that is not offered
        return tuple(saved)
    ids, sources = {one.id for one in kept}, {one.source for one in kept}
    rest = (one for one in saved if one.id not in ids and one.source not in sources)
    return (*kept, *rest)


def has_news(draft: Draft, begun: Draft) -> bool:
    """Whether a step after Cameras has found something that was not there in the beginning."""
    return (
        draft.board not in (None, begun.board)
        or draft.stature_m not in (None, begun.stature_m)
        or any(
            one is not None and one is not before
            for one, before in ((draft.rig, begun.rig), (draft.factors, begun.factors))
        )
        or any(one is not begun.intrinsics.get(name) for name, one in draft.intrinsics.items())
        or any(one is not begun.colours.get(name) for name, one in draft.colours.items())
    )
