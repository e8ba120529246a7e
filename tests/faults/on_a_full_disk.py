"""Saves, caches and records on a disk that gets full, in a small one of its own, and says what came of it as JSON.

    unshare --map-root-user --mount python -m tests.faults.on_a_full_disk FOLDER

For each of calibration, cache and recording: the error's words, and what is there afterwards.
"""

import errno
import json
import subprocess
import sys
from collections.abc import Callable
from itertools import count
from pathlib import Path

from mocapd.errors import CannotCreateError
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.mcap.recording_writer import RecordingParams, RecordingWriter
from mocapd.outputs.wire import SkeletonFrame
from tests.faults.endless_writer import (
    cache_number,
    cached_number,
    draft_of_small,
    save_calibration,
    saved_number,
)
from tests.outputs.recorded import HZ, cameras, frame_at, rest

_DISK = "12m"


def fill(folder: Path) -> Path:
    """A file that takes all the room there is."""
    path = folder / "filler"
    with path.open("wb", buffering=0) as file:
        for size in (1 << 20, 1 << 12, 1):
            try:
                while True:
                    file.write(bytes(size))
            except OSError as error:
                if error.errno != errno.ENOSPC:
                    raise
    return path


def refused(write: Callable[[], None]) -> str:
    """The error's words; empty when there was none."""
    try:
        write()
    except CannotCreateError as error:
        return str(error)
    return ""


def kept_whole(
    folder: Path, write: Callable[[int], None], read: Callable[[], int | None]
) -> dict[str, object]:
    """Written once, then on a full disk, then when there is room again."""
    folder.mkdir(mode=0o700)
    write(7)
    filler = fill(folder)
    said = refused(lambda: write(8))
    kept, left = read(), [one.name for one in folder.rglob(".*") if one.is_file()]
    filler.unlink()
    write(9)
    return {"said": said, "kept": kept, "left": left, "then": read()}


def recorded(folder: Path) -> dict[str, object]:
    """Until the disk is full."""
    path = folder / "a.mcap"
    first = frame_at(0.0, 0)
    writer = RecordingWriter(path, RecordingParams(exact=True), first.capture_monotonic_ns)
    writer.add_state(cameras(), first.capture_unix_ns)
    writer.add_state(rest(), first.capture_unix_ns)
    said, handed_over = "", 0
    filler = folder / "filler"
    for number in count():
        frame = frame_at(number / HZ, number)
        try:
            writer.frame(frame)
            writer.flush_if_due(frame.capture_monotonic_ns)
        except CannotCreateError as error:
            said = str(error)
            break
        handed_over = number + 1
        if number == round(3 * HZ):
            filler = fill(folder)
    at_the_end = refused(writer.close)
    read = sum(isinstance(one, SkeletonFrame) for one in RecordingReader(path).everything())
    filler.unlink()
    return {"said": said, "at_the_end": at_the_end, "handed_over": handed_over, "read": read}


def main() -> None:
    """Everything, on a disk of its own."""
    disk = Path(sys.argv[1])
    mount = ["mount", "-t", "tmpfs", "-o", f"size={_DISK}", "none", str(disk)]
    subprocess.run(mount, check=True)
    draft = draft_of_small()
    calibration, cache = disk / "state", disk / "cache"
    found = {
        "calibration": kept_whole(
            calibration,
            lambda number: save_calibration(calibration, draft, number),
            lambda: saved_number(calibration),
        ),
        "cache": kept_whole(
            cache, lambda number: cache_number(cache, number), lambda: cached_number(cache)
        ),
        "recording": recorded(disk),
    }
    print(json.dumps(found))


if __name__ == "__main__":
    main()
