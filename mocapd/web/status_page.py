"""What other processes ask of a running page: is it alive, begin a setup."""

from typing import Annotated

import msgspec
from msgspec import Meta


class Status(msgspec.Struct, frozen=True):
    """GET /status. setup: the step that is shown; None without a setup. tracks: whether bodies come;
    origins,
    frames_key: see FramesAccess."""

    version: str
    pid: int
    cameras: tuple[str, ...]
    setup: str | None
    tracks: bool
    origins: tuple[str, ...] = ()
    frames_key: str = ""


class SetupRequest(msgspec.Struct, frozen=True):
    """POST /setup: begin one, or go on with the one there is; `step`: shown at once."""

    step: Annotated[str, Meta(max_length=100)] | None = None


class SetupAnswer(msgspec.Struct, frozen=True):
    """Its answer: empty when the setup is going on, else (503) why it cannot be now."""

    what: str = ""
    where: str = ""
    fix: str = ""
