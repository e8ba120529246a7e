"""Looks for the board once in each picture, however often a test shows that picture, and solves once from
the same views.

What a detector finds depends on the board and the picture alone, and what is solved on the views alone;
tests show the same picture for many ticks, and calibrate from the same folder several times.
"""

import hashlib
import pickle
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import pytest

from mocapd.calibrate.board.board_detection import BoardDetector, BoardView
from mocapd.calibrate.extrinsics import folder_calibration
from mocapd.calibration.board_spec import BoardSpec
from mocapd.types import Bytes, Ints

_Key = tuple[BoardSpec, tuple[int, ...], int]

_views: dict[_Key, BoardView | None] = {}
_markers: dict[_Key, Ints] = {}
_digests: dict[
    int, tuple["weakref.ref[Any]", int]
] = {}  # of pictures that cannot be written to, by id
_solved: dict[tuple[str, bytes], Any] = {}


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
        for name in ("solve_intrinsics", "solve_extrinsics"):
            solve = getattr(folder_calibration, name)
            patch.setattr(folder_calibration, name, _once(name, solve))
        yield


def _once(name: str, solve: Callable[..., Any]) -> Callable[..., Any]:
    """What it returned for arguments of the same content; a refusal is made anew."""

    def solve_once(*arguments: Any) -> Any:
        key = (name, hashlib.blake2b(pickle.dumps(arguments), digest_size=16).digest())
        if key not in _solved:
            _solved[key] = solve(*arguments)
        return _solved[key]

    return solve_once


def _key(detector: BoardDetector, pixels: Any) -> _Key:
    return detector.spec, pixels.shape, _digest(pixels)


def _digest(pixels: Any) -> int:
    """Of what is in the picture; it is read once only where it is sure to stay the same."""
    known = _digests.get(id(pixels))
    if known is not None and known[0]() is pixels:
        return known[1]
    digest = hash(pixels.tobytes())  # 64 bits, in a seventh of the time that blake2b takes
    if pixels.base is None and not pixels.flags.writeable:
        _digests[id(pixels)] = weakref.ref(pixels), digest
    return digest


def never_written(pixels: Bytes) -> Bytes:
    """The same picture, which can no longer be written to."""
    assert pixels.base is None
    pixels.flags.writeable = False
    return pixels
