"""Requests and answers of the control socket: one line of JSON each way, then it is closed."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

STATUS = "mocapd.Status.v1"

Verb = Literal["status", "recenter", "reload"]


class Request(msgspec.Struct, frozen=True):
    """A command for the daemon."""

    verb: Verb


class Refused(msgspec.Struct, frozen=True):
    """The error of a refused request; exit_code: of the MocapdError."""

    what: str
    where: str
    fix: str
    exit_code: int


class Answer(msgspec.Struct, frozen=True, omit_defaults=True):
    """told: a StatusReport, Recentered or Reloaded, by the request's verb; or `refused`."""

    told: msgspec.Raw = msgspec.Raw(b"null")
    refused: Refused | None = None


class Recentered(msgspec.Struct, frozen=True):
    """yaw_deg: see messages.Facing; outputs: names of the informed outputs."""

    yaw_deg: Annotated[float, Meta(ge=-180, le=180)]
    outputs: tuple[str, ...]


class Reloaded(msgspec.Struct, frozen=True):
    """gap_s: time without frames, while cameras were reopened [s]; waiting: changed keys and sections that need a restart
    to take effect."""

    gap_s: float
    waiting: tuple[str, ...]


class CameraStatusReport(msgspec.Struct, frozen=True):
    """One camera. state: live, silent, starting, lost or ended; detail: why; rate_hz: pictures a second;
    mounting: steady, bumped, swapped or unknown. Passwords are not in `source`."""

    id: str
    state: str
    detail: str
    source: str
    rate_hz: float
    frames: int
    lost_frames: int
    reopened: int
    mounting: str


class OutputReport(msgspec.Struct, frozen=True):
    """One output. listeners: -1 where the protocol has no count; not_sent: frames without a listener, refused, or too
    late."""

    name: str
    sent: int
    not_sent: int
    listeners: int
    detail: str


class CalibrationReport(msgspec.Struct, frozen=True):
    """The calibration in use. made_unix_s: None if its file has no date."""

    source: str
    made_unix_s: float | None = None


class Trouble(msgspec.Struct, frozen=True):
    """The newest warning or error of the log."""

    at_unix_s: float
    level: str
    text: str


class StatusReport(msgspec.Struct, frozen=True):
    """The status of a daemon. state: see service.readiness; latencies: capture to publish, None before the first frame;
    lag_median_ms: additional lag of a moving person's pose, by the tracker's filter and smoothing; published: frames since
    the start; dropped: frame sets replaced by newer ones; lost_reason: for users, why motion is not tracked, and the fix;
    mostly empty; effort, slowness: see messages.Health; preparing: remaining work of a first start, for users."""

    version: str
    pid: int
    instance: str
    state_dir: str
    state: Literal["tracking", "nobody", "slow", "starting", "blind"]
    tracker: str
    tracking: str
    rate_hz: float
    latency_median_ms: float | None
    latency_p95_ms: float | None
    published: int
    dropped: int
    uptime_s: float
    cameras: tuple[CameraStatusReport, ...]
    outputs: tuple[OutputReport, ...]
    calibration: CalibrationReport | None = None
    last_trouble: Trouble | None = None
    lost_reason: str = ""
    schema: str = STATUS
    effort: str = "full"
    lag_median_ms: float | None = None
    preparing: str = ""
    slowness: str = ""
