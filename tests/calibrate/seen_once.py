"""Looks for the board once in each picture, however often a test shows that picture.

What a detector finds depends on the board and the picture alone; tests show the same picture for many ticks.
"""

import hashlib
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest

from mocapd.calibrate.board.board_detection import BoardDetector, BoardView
from mocapd.calibration.board_spec import BoardSpec
from mocapd.types import Bytes, Ints

_Key = tuple[BoardSpec, tuple[int, ...], bytes]

_views: dict[_Key, BoardView | None] = {}
_markers: dict[_Key, Ints] = {}
_digests: dict[
    int, tuple["weakref.ref[Any]", bytes]
] = {}  # of pictures that cannot be written to, by id


@contextmanager
def seen_once() -> Iterator[None]:
    """Every detector remembers what any found, in this process."""
    find, markers = BoardDetector.find, BoardDetector.markers

    def find_once(detector: BoardDetector, pixels: Bytes, index: int = 0) -> BoardView | None:
        key = _key(detector, pixels)
        if key not in _views:
            _views[key] = find(detector, pixels, index)
        view = _views[key]
        return None if view is None else replace(view, index=index)

    def markers_once(detector: BoardDetector, grey: Bytes) -> Ints:
        key = _key(detector, grey)
        if key not in _markers:
            _markers[key] = markers(detector, grey)
        return _markers[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(BoardDetector, "find", find_once)
        patch.setattr(BoardDetector, "markers", markers_once)
        yield


def _key(detector: BoardDetector, pixels: Any) -> _Key:
    return detector.spec, pixels.shape, _digest(pixels)


def _digest(pixels: Any) -> bytes:
    """Of what is in the picture; it is read once only where it is sure to stay the same."""
    known = _digests.get(id(pixels))
    if known is not None and known[0]() is pixels:
        return known[1]
    digest = hashlib.blake2b(pixels.tobytes(), digest_size=16).digest()
    if pixels.base is None and not pixels.flags.writeable:
        _digests[id(pixels)] = weakref.ref(pixels), digest
    return digest


def never_written(pixels: Bytes) -> Bytes:
    """The same picture, which can no longer be written to."""
    assert pixels.base is None
    pixels.flags.writeable = False
    return pixels
