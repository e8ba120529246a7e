"""Where several cameras are of: a recording or a scenario, which also knows how they stood and who was there."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from mocapd.capture.base import Source
from mocapd.capture.source_request import SourceRequest
from mocapd.types import FrameSet, LabelledPicture, Rig

Progress = Callable[[str, int, int], None]  # what is being made, parts done, parts in all


class Origin(Protocol):
    """An origin that is open. `rig_source`: where its rig is from, for people; `count`: its frame sets."""

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
        """The shirt in neutral light. Raises InputError or ConfigError."""
        ...

    def white_balance(self) -> Mapping[str, LabelledPicture]:
        """By camera, the shirt in the place's own light. Raises InputError."""
        ...

    def frame_sets(self) -> Iterator[FrameSet]:
        """All of it once, from time 0, as fast as it decodes."""
        ...

    def source(self, address: str, request: SourceRequest) -> Source:
        """One of its cameras. Raises ConfigError for one that it has not."""
        ...


@dataclass(frozen=True, slots=True)
class OriginKind:
    """What a kind of source knows of origins, whose names are addresses without a camera.

    cameras(origin): their names. open(origin, cache_dir, progress): it may be made first, and kept in the
    cache. open_beginning: likewise, what can be had sooner, where that is another. All raise InputError or ConfigError.
    """

    cameras: Callable[[str], tuple[str, ...]]
    open: Callable[[str, Path, Progress], Origin]
    open_beginning: Callable[[str, Path, Progress], Origin] | None = None


def camera_address(origin: str, camera: str) -> str:
    """One camera of an origin."""
    return f"{origin}#{camera}"


def split_address(address: str) -> tuple[str, str]:
    """Origin and camera; the origin is empty for a camera by itself."""
    origin, _, camera = address.rpartition("#")
    return origin, camera
