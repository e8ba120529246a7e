"""The live status line of a running daemon."""

import math
from collections.abc import Callable

from rich.console import Console
from rich.live import Live
from rich.text import Text

from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.outputs.base import SinkStatus
from mocapd.service.service import Snapshot
from mocapd.tracking.effort import Effort


def status_text(snapshot: Snapshot) -> str:
    """One line: rate, latency, tracker and its state, each camera's rate, and the outputs' listeners."""
    m = snapshot.metrics
    parts = [f"{m.rate_hz:4.1f} Hz"]
    if not math.isnan(m.latency_ms.median):
        parts.append(f"{m.latency_ms.median:.0f} ms (p95 {m.latency_ms.p95:.0f})")
    parts.append(f"{m.tracker} {m.tracking.value}" if m.tracker else "no frame yet")
    parts += [m.lost_reason.what] if m.lost_reason is not None else []
    parts.append(" ".join(_camera(status) for status in snapshot.cameras.values()))
    parts += [f"{name}: {_listeners(status)}" for name, status in snapshot.outputs.items()]
    if m.slowness is not None:
        parts.append(m.slowness.what)
    elif m.effort is not Effort.FULL:
        parts.append(f"{m.effort.value} effort: this machine is too slow")
    if m.sets_dropped:
        parts.append(f"{m.sets_dropped} dropped")
    return " | ".join(parts)


def _camera(status: CaptureStatus) -> str:
    """The rate of a live camera, else its trouble."""
    if status.is_silent:
        return f"{status.camera} silent {status.silent_s:.0f} s"
    if status.state is CaptureState.LIVE:
        trouble = " (see the log)" if status.notice else ""
        return f"{status.camera} {status.fps_hz:.1f}{trouble}"
    return f"{status.camera} {status.state.value}"


def _listeners(status: SinkStatus) -> str:
    return "nobody listens" if status.listeners == 0 else status.detail


class StatusLine:
    """A line on stderr that is overwritten; without a terminal nothing, as the log has the changes."""

    def __init__(self) -> None:
        self._console = Console(stderr=True)
        self._live: Live | None = None

    def __enter__(self) -> "StatusLine":
        if self._console.is_terminal:
            self._live = Live(console=self._console, auto_refresh=False, redirect_stdout=False)
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._live is not None:
            self._live.stop()

    def show(self, snapshot: Snapshot, remark: str = "") -> None:
        """Updates the line; `remark` is its prefix."""
        self.say(lambda: f"{remark} | {status_text(snapshot)}" if remark else status_text(snapshot))

    def say(self, text: Callable[[], str]) -> None:
        """Shows another line, evaluated only if it is shown."""
        if self._live is not None:
            line = Text(text(), no_wrap=True, overflow="ellipsis")
            self._live.update(line, refresh=True)
