"""The page's folder of recordings, and the recording in progress."""

import logging
import os
import re
import subprocess
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, BinaryIO

import msgspec
from msgspec import Meta

from mocapd.boundary.files import MissingError, is_absent, is_file, read_text
from mocapd.boundary.folders import private_folder
from mocapd.boundary.listing import shown_in
from mocapd.boundary.parsing import decode_json
from mocapd.child_process import child_command
from mocapd.errors import (
    CannotCreateError,
    InputError,
    UnavailableError,
    creation_errors,
    mend_of,
)
from mocapd.quarantine import quarantine
from mocapd.service.body_recorder import BodyRecorder
from mocapd.whole_file import whole_file

_log = logging.getLogger(__name__)
_ROOM = "make room there"

MOST_LISTED = 200
FORMATS = ("bvh", "glb", "vrma", "csv", "trc", "c3d")
_ID = re.compile(r"\d{8}-\d{6}")
_MOST_NOTE_BYTES = 1 << 14
_EXPORT_S = 300.0

Name = Annotated[str, Meta(max_length=80)]
Notes = Annotated[str, Meta(max_length=2000)]


class Note(msgspec.Struct, frozen=True):
    """The note file of a recording: name, notes, and length [s]."""

    name: Name = ""
    notes: Notes = ""
    length_s: float | None = None
    schema: str = "mocapd.RecordingNote.v1"


class RecordingRow(msgspec.Struct, frozen=True):
    """One recording as the page lists it. length_s: null where its process was killed."""

    id: str
    name: str
    notes: str
    length_s: float | None
    size_bytes: int


class NowRecording(msgspec.Struct, frozen=True):
    id: str
    length_s: float
    frames: int
    trouble: str


class RecordingList(msgspec.Struct, frozen=True):
    """All recordings, newest first."""

    folder: str
    now: NowRecording | None
    recordings: tuple[RecordingRow, ...]
    formats: tuple[str, ...] = FORMATS


class Recordings:
    """Thread-safe, used by the page's threads; `close` ends a recording in progress."""

    def __init__(self, folder: Path, begin: Callable[[Path], BodyRecorder]) -> None:
        """begin: makes a recorder to a file, which this class enters and exits; it raises MocapdError."""
        self.folder, self._begin = folder, begin
        self._lock = threading.Lock()  # guards what follows
        self._recorder: BodyRecorder | None = None

    def start(self) -> None:
        """Starts a recording. Raises UnavailableError during another one, CannotCreateError."""
        with self._lock:
            if self._recorder is not None:
                raise UnavailableError("a recording is being made", "recordings", "stop it first")
            with creation_errors(self.folder, _ROOM, "cannot be made"):
                private_folder(self.folder)
            self._recorder = self._begin(self._new_path()).__enter__()

    def _new_path(self) -> Path:
        """Named by the time; by the next free second after another one of this second, or after the clock was set back."""
        seconds = map(time.localtime, count(int(time.time())))
        paths = (self.folder / f"{time.strftime('%Y%m%d-%H%M%S', now)}.mcap" for now in seconds)
        return next(filter(is_absent, paths))

    def stop(self) -> None:
        """Ends the recording in progress, if any. Raises CannotCreateError, also where its end is missing."""
        with self._lock:
            recorder, self._recorder = self._recorder, None
            if recorder is None:
                return
            recorder.__exit__()
            self._write(recorder.path.stem, Note(length_s=round(recorder.length_s, 1)))
            if recorder.error is not None:
                raise recorder.error

    close = stop

    def note(self, id_: str, name: str, notes: str) -> None:
        """Writes name and notes of a recording; quarantines an unreadable note. Raises InputError for an unknown one,
        CannotCreateError."""
        self.file(id_)
        try:
            before = self._stored(id_)
        except MissingError:
            before = Note()
        except InputError as error:
            self._quarantine(id_, error)
            before = Note()
        self._write(id_, msgspec.structs.replace(before, name=name, notes=notes))

    def list(self) -> RecordingList:
        """All recordings; empty without a folder. Raises InputError for one that cannot be listed."""
        recorder = self._recorder
        now = None
        if recorder is not None:
            now = NowRecording(
                recorder.path.stem, recorder.length_s, recorder.frames, recorder.trouble
            )
        paths = [path for path in shown_in(self.folder) if path.suffix == ".mcap"]
        rows = []
        for path in paths[::-1][:MOST_LISTED]:
            if _ID.fullmatch(path.stem) and (now is None or path.stem != now.id):
                note = self._read(path.stem)
                with suppress(OSError):
                    size_bytes = path.stat().st_size
                    rows.append(
                        RecordingRow(path.stem, note.name, note.notes, note.length_s, size_bytes)
                    )
        return RecordingList(str(self.folder), now, tuple(rows))

    def file(self, id_: str) -> Path:
        """The path of a recording. Raises InputError for an unknown one."""
        path = self.folder / f"{id_}.mcap"
        if not _ID.fullmatch(id_) or not is_file(path):
            raise InputError("there is no such recording", "recordings", "reload the page")
        return path

    def opened(self, id_: str) -> BinaryIO:
        """A recording, open to be read. Raises InputError."""
        path = self.file(id_)
        try:
            return path.open("rb")
        except OSError as error:
            raise InputError(
                f"cannot be read ({error.strerror})", str(path), "check its rights, and the disk"
            ) from None

    def file_name(self, id_: str, suffix: str) -> str:
        """The file name for the browser: the recording's name, else its id."""
        name = re.sub(r"[^A-Za-z0-9._-]+", "-", self._read(id_).name).strip("-.")
        return f"{name or f'mocapd-{id_}'}.{suffix}"

    def export(self, id_: str, format_: str) -> BinaryIO:
        """Converts a recording, in a process of its own so that tracking goes on; the result is open to be read, and gone
        once it is closed. Raises InputError, CannotCreateError."""
        path = self.file(id_)
        if format_ not in FORMATS:
            raise InputError("there is no such format", "recordings", "reload the page")
        try:
            with TemporaryDirectory(prefix="mocapd-export-") as folder:
                return _exported(path, Path(folder) / f"{id_}.{format_}")
        except OSError as error:
            raise CannotCreateError(
                f"the export cannot be made ({error.strerror})",
                str(error.filename or id_),
                mend_of(error, "use `mocapd export`"),
            ) from None

    def _read(self, id_: str) -> Note:
        """The note; empty without a readable file, as the recording stays usable."""
        try:
            return self._stored(id_)
        except InputError:
            return Note()

    def _stored(self, id_: str) -> Note:
        """Raises MissingError or InputError."""
        return decode_json(read_text(self._note_path(id_), _MOST_NOTE_BYTES).encode(), Note)

    def _quarantine(self, id_: str, error: InputError) -> None:
        """Raises CannotCreateError."""
        path = self._note_path(id_)
        with creation_errors(path, _ROOM):
            _log.warning(
                "%s cannot be used (%s), and is now %s", path, error.what, quarantine(path)
            )

    def _write(self, id_: str, note: Note) -> None:
        path = self._note_path(id_)
        with creation_errors(path, _ROOM), whole_file(path, private=True) as partial:
            partial.write_bytes(msgspec.json.encode(note))

    def _note_path(self, id_: str) -> Path:
        return self.folder / f"{id_}.json"


def _exported(path: Path, out: Path) -> BinaryIO:
    """The recording in the format of `out`'s suffix. Raises InputError, OSError."""
    words = ("export", str(path), "--to", out.suffix[1:], "--out", str(out))
    command = child_command("from mocapd.cli.main import main; main()", *words)
    # an export has no use for the daemon's configuration
    env = {name: value for name, value in os.environ.items() if name[:7] != "MOCAPD_"}
    try:
        done = subprocess.run(
            command, capture_output=True, text=True, check=False, timeout=_EXPORT_S, env=env
        )
    except subprocess.TimeoutExpired:
        raise InputError(
            f"takes more than {_EXPORT_S:.0f} s", path.stem, "use `mocapd export`"
        ) from None
    if done.returncode != 0 or not out.is_file():
        lines = done.stderr.strip().splitlines()
        raise InputError(
            lines[-1][:300] if lines else "the export failed", path.stem, "use `mocapd export`"
        )
    return out.open("rb")
