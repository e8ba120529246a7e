"""The status of a running daemon as text."""

import time

from mocapd.control.control_messages import CameraStatusReport, OutputReport, StatusReport
from mocapd.errors import one_line
from mocapd.service.health import effort_text

_STATES = {
    "tracking": "tracking",
    "nobody": "nobody in view",
    "slow": "too slow",
    "starting": "starting",
    "blind": "no camera delivers",
}
_DAY_S = 86400.0


def status_lines(report: StatusReport, now_unix_s: float | None = None) -> list[str]:
    """One line per subject; now_unix_s: reference of ages, the present when None."""
    now_unix_s = time.time() if now_unix_s is None else now_unix_s
    rows = [
        (
            "daemon",
            f"{report.instance}, mocapd {report.version}, pid {report.pid}, up {duration(report.uptime_s)}",
        ),
        ("state", f"{_state(report)} ({report.tracker}, {report.tracking})"),
        *((("preparing", report.preparing),) if report.preparing else ()),
        ("rate", _rate(report)),
        *((("effort", effort),) if (effort := _effort(report)) else ()),
        ("calibration", _calibration(report, now_unix_s)),
        *((f"camera {camera.id}", _camera(camera)) for camera in report.cameras),
        *((f"output {output.name}", _output(output)) for output in report.outputs),
        ("last trouble", _trouble(report, now_unix_s)),
    ]
    width = max(len(name) for name, _ in rows)
    return [one_line(f"{name:<{width}}  {text}") for name, text in rows]


def duration(span_s: float) -> str:
    """In the two largest units: `3 d 4 h`, `12 min 5 s`."""
    rest = max(0, round(span_s))
    parts = []
    for unit, size_s in (("d", 86400), ("h", 3600), ("min", 60), ("s", 1)):
        count, rest = divmod(rest, size_s)
        parts.append((count, unit))
    first = next((i for i, (count, _) in enumerate(parts) if count), len(parts) - 1)
    return " ".join(f"{count} {unit}" for count, unit in parts[first : first + 2])


def _state(report: StatusReport) -> str:
    """The state, with its reason where one is given."""
    if report.state == "nobody" and report.lost_reason:
        return f"nobody is tracked: {report.lost_reason}"
    if report.state == "slow" and report.slowness:
        return report.slowness
    return _STATES[report.state]


def _effort(report: StatusReport) -> str:
    """Empty without pictures: the effort is that of the last ones, and no machine is too slow for none."""
    return "" if report.state == "blind" else effort_text(report.effort)


def _rate(report: StatusReport) -> str:
    text = f"{report.rate_hz:.1f} Hz"
    if report.latency_median_ms is not None and report.latency_p95_ms is not None:
        text += f", latency {report.latency_median_ms:.0f} ms (p95 {report.latency_p95_ms:.0f})"
    if report.lag_median_ms:
        text += f" and {report.lag_median_ms:.0f} ms of smoothing"
    return f"{text}, {report.published} frames, {report.dropped} dropped"


def _calibration(report: StatusReport, now_unix_s: float) -> str:
    calibration = report.calibration
    if calibration is None:
        return "none"
    if calibration.made_unix_s is None:
        return calibration.source
    return f"{_ago(now_unix_s - calibration.made_unix_s)}, {calibration.source}"


def _ago(span_s: float) -> str:
    if span_s < _DAY_S:
        return "of today"
    days = int(span_s / _DAY_S)
    return f"{days} day{'s' if days > 1 else ''} old"


def _camera(camera: CameraStatusReport) -> str:
    parts = [f"live {camera.rate_hz:.1f} Hz" if camera.state == "live" else camera.state]
    parts += [camera.detail] if camera.detail else []
    parts += ["bumped: calibrate the room again"] if camera.mounting == "bumped" else []
    parts += ["shows what another camera should"] if camera.mounting == "swapped" else []
    parts += _count(camera.lost_frames, "lost frame", "lost frames")
    parts += _count(camera.reopened, "time reopened", "times reopened")
    return ", ".join(parts)


def _output(output: OutputReport) -> str:
    listeners = "" if output.listeners < 0 else f"{output.listeners} listening, "
    return f"{listeners}{output.sent} sent, {output.not_sent} not: {output.detail}"


def _count(count: int, one: str, several: str) -> list[str]:
    return [f"{count} {one if count == 1 else several}"] if count else []


def _trouble(report: StatusReport, now_unix_s: float) -> str:
    if report.last_trouble is None:
        return "none"
    ago = duration(now_unix_s - report.last_trouble.at_unix_s)
    return f"{ago} ago: {report.last_trouble.text}"
