"""Reads a recording: its frames as they were published, and the states between them."""

import logging
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mocapd.boundary.mcap_records import McapAttachment, McapFile, McapMessage
from mocapd.errors import InputError
from mocapd.outputs.mcap.packed_frame import PACKED, decode_packed, unpack
from mocapd.outputs.messages import (
    CALIBRATION,
    REST_SKELETON,
    CalibrationInfo,
    RestSkeleton,
    decode_rest_skeleton,
)
from mocapd.outputs.wire import SCHEMA, SkeletonFrame, decode, decode_message

_log = logging.getLogger(__name__)

Recorded = SkeletonFrame | RestSkeleton | CalibrationInfo
_OURS = (SCHEMA, PACKED, REST_SKELETON, CALIBRATION)
_FAMILIES = tuple(name.rpartition(".")[0] + "." for name in _OURS)  # each without its version

_MOST_REFUSED = 5_000  # messages, before reading ends unless more were good

_NO_SKELETON = RestSkeleton("", 0, 0.0, (), (), ())  # before the first rest skeleton


@dataclass(slots=True)
class _Counts:
    """Of one pass through the file. other: the first schema of another version of mocapd."""

    frames: int = 0
    refused: int = 0
    other: str = ""


class RecordingReader:
    """One file; every call reads it from its start."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def everything(self) -> Iterator[Recorded]:
        """Frames and states in recorded order; at the end it logs what was damaged.

        Raises InputError where the file is no recording, or has no frame that this version reads.
        """
        file, counts = McapFile(self.path), _Counts()
        rests: dict[int, RestSkeleton] = {}
        for item in file.items(lambda _topic, schema: schema.startswith(_FAMILIES)):
            if isinstance(item, McapAttachment):
                continue
            if item.schema not in _OURS:
                counts.other = counts.other or item.schema
                continue
            try:
                message = _decode(item, rests)
            except InputError:
                counts.refused += 1
                if counts.refused > max(_MOST_REFUSED, counts.frames):
                    file.ending = "it holds more damaged messages than frames"
                    break
                continue
            if isinstance(message, RestSkeleton):
                rests[message.person] = message
            counts.frames += isinstance(message, SkeletonFrame)
            yield message
        self._report(file, counts)

    def _report(self, file: McapFile, counts: _Counts) -> None:
        """Log the damage. Raises InputError where no frame could be read."""
        place = str(self.path)
        if counts.frames == 0 and counts.other:
            raise InputError(
                f"was recorded by another version of mocapd, whose frames are {counts.other!r}",
                place,
                f"this version reads {SCHEMA} and {PACKED}: bring it to the same version",
            )
        if counts.frames == 0:
            raise InputError(
                "holds no frame of mocapd" + (f": {file.ending}" if file.ending else ""),
                place,
                "give a file of `mocapd record`",
            )
        if file.ending:
            _log.warning("%s: %s; what came before is used", place, file.ending)
        if file.damaged or counts.refused:
            _log.warning(
                "%s: %d chunks and %d messages are damaged, and left out",
                *(place, file.damaged, counts.refused),
            )


def _decode(message: McapMessage, rests: dict[int, RestSkeleton]) -> Recorded:
    """Raises InputError."""
    mime = f"application/{message.encoding}"
    if message.schema == PACKED:
        packed = decode_packed(message.data, mime)
        return unpack(packed, rests.get(packed.person, _NO_SKELETON))
    if message.schema == SCHEMA:
        return decode(message.data, mime)
    if message.schema == REST_SKELETON:
        return decode_rest_skeleton(message.data, mime)
    return decode_message(message.data, mime, CalibrationInfo, CALIBRATION)
