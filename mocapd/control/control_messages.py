"""What is asked at the control socket, and answered: one line of JSON each way, then it is closed."""

from typing import Annotated, Literal

import msgspec
from msgspec import Meta

STATUS = "mocapd.Status.v1"

Verb = Literal["status", "recenter", "reload"]


class Request(msgspec.Struct, frozen=True):
    """What the daemon shall do."""

    verb: Verb


class Refused(msgspec.Struct, frozen=True):
    """Why it was not done; exit_code: of the MocapdError."""

    what: str
    where: str
    fix: str
    exit_code: int


class Answer(msgspec.Struct, frozen=True, omit_defaults=True):
    """told: a StatusReport, Recentered or Reloaded, by what was asked; or `refused`."""

    told: msgspec.Raw = msgspec.Raw(b"null")
    refused: Refused | None = None


class Recentered(msgspec.Struct, frozen=True):
    """yaw_deg: see messages.Facing; outputs: those that were told."""

    yaw_deg: Annotated[float, Meta(ge=-180, le=180)]
    outputs: tuple[str, ...]


class Reloaded(msgspec.Struct, frozen=True):
    """gap_s: without a frame, while cameras were closed and opened [s]; waiting: keys and sections that were
    changed, but are taken up by the next start alone."""

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
    """One output. listeners: -1 where the protocol cannot tell; not_sent: frames that nobody listened to, that were
    refused, or that came too late for it."""

    name: str
    sent: int
    not_sent: int
    listeners: int
    detail: str


class CalibrationReport(msgspec.Struct, frozen=True):
    """What is tracked with. made_unix_s: None where its file does not say."""

    source: str
    made_unix_s: float | None = None


class Trouble(msgspec.Struct, frozen=True):
    """The newest warning or error of the log."""

    at_unix_s: float
    level: str
    text: str


class StatusReport(msgspec.Struct, frozen=True):
    """How a daemon fares. state: see service.fitness; latencies: capture to publish, None before the first frame;
    lag_median_ms: how much older than that the pose of somebody who moves is, by the tracker's filter and smoothing;
    published: frames since the start; dropped: frame sets displaced by newer ones; lost_reason: for people, why nobody is
    tracked though somebody moves, and what they can do; mostly empty; effort, slowness: see messages.Health; preparing: what
    a first start still prepares, for people."""

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
