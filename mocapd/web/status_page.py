"""Messages between a running page and other processes: status, and the start of a setup."""

from typing import Annotated

import msgspec
from msgspec import Meta


class Status(msgspec.Struct, frozen=True):
    """GET /status. setup: the current step; None without a setup. tracks: whether a tracker runs;
    origins, frames_key: see FramesAccess."""

    version: str
    pid: int
    cameras: tuple[str, ...]
    setup: str | None
    tracks: bool
    origins: tuple[str, ...] = ()
    frames_key: str = ""


class SetupRequest(msgspec.Struct, frozen=True):
    """POST /setup: start a setup, or continue the current one; `step`: the step to show."""

    step: Annotated[str, Meta(max_length=100)] | None = None


class SetupAnswer(msgspec.Struct, frozen=True):
    """Its answer: empty on success, else (503) the error."""

    what: str = ""
    where: str = ""
    fix: str = ""
