"""The common origin of several cameras: a recording or a scenario, with its rig and its wearer."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from mocapd.capture.base import Source
from mocapd.capture.source_request import SourceRequest
from mocapd.types import FrameSet, LabelledPicture, Rig

Progress = Callable[[str, int, int], None]  # task, parts done, parts in all


class Origin(Protocol):
    """An open origin. `rig_source`: file or scenario of its rig, for users; `count`: number of frame sets."""

    @property
    def rig(self) -> Rig: ...
    @property
    def rig_source(self) -> str: ...
    @property
    def stature_m(self) -> float | None: ...
    @property
    def fps_hz(self) -> float: ...
    @property
    def count(self) -> int: ...

    def model(self) -> tuple[LabelledPicture, ...]:
        """Labelled pictures of the shirt in neutral light. Raises InputError or ConfigError."""
        ...

    def white_balance(self) -> Mapping[str, LabelledPicture]:
        """By camera, the shirt in the scene's light. Raises InputError."""
        ...

    def frame_sets(self) -> Iterator[FrameSet]:
        """All frame sets once, from time 0, as fast as they decode."""
        ...

    def source(self, address: str, request: SourceRequest) -> Source:
        """One of its cameras. Raises ConfigError for an unknown one."""
        ...


@dataclass(frozen=True, slots=True)
class OriginKind:
    """The origins of a kind of source; an origin's name is an address without a camera.

    cameras(origin): camera names. open(origin, cache_dir, progress): opens the origin, possibly rendering it into the
    cache first. open_beginning: the same for a part that is ready sooner. is_made(origin, cache_dir): False if `open` would
    render. All raise InputError or ConfigError.
    """

    cameras: Callable[[str], tuple[str, ...]]
    open: Callable[[str, Path, Progress], Origin]
    open_beginning: Callable[[str, Path, Progress], Origin] | None = None
    is_made: Callable[[str, Path], bool] = lambda _origin, _cache_dir: True


def camera_address(origin: str, camera: str) -> str:
    """The address of one camera of an origin."""
    return f"{origin}#{camera}"


def split_address(address: str) -> tuple[str, str]:
    """Origin and camera; the origin is empty for a camera without one."""
    origin, _, camera = address.rpartition("#")
    return origin, camera
