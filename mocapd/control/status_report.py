"""Builds the answer to `mocapd status` from a running service."""

import math
import os
from collections.abc import Mapping
from datetime import UTC, datetime

import mocapd
from mocapd.capture.camera_thread.capture_status import CaptureStatus
from mocapd.config.sections import Config
from mocapd.control.control_messages import (
    CalibrationReport,
    CameraStatusReport,
    OutputReport,
    StatusReport,
    Trouble,
)
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.messages import CameraStatus
from mocapd.service.health import lost_reason_text, slowness_text
from mocapd.service.open_outputs import OpenOutputs
from mocapd.service.readiness import readiness_of
from mocapd.service.service import Service
from mocapd.session.session import Session
from mocapd.types import Tracking

SILENT = "silent"  # a live camera that sends nothing


def status_report(
    service: Service, last_trouble: Trouble | None, preparing: str = ""
) -> StatusReport:
    """The service's status; thread-safe. preparing: remaining preparations."""
    snapshot, session = service.snapshot(), service.session
    metrics, cameras = snapshot.metrics, service.camera_messages()
    return StatusReport(
        version=mocapd.__version__,
        pid=os.getpid(),
        instance=service.instance,
        state_dir=str(service.config.state_dir.resolve()),
        state=readiness_of(snapshot),
        tracker=metrics.tracker or session.tracker.name,
        tracking=metrics.tracking.value,
        rate_hz=metrics.rate_hz,
        latency_median_ms=_finite(metrics.latency_ms.median),
        latency_p95_ms=_finite(metrics.latency_ms.p95),
        published=metrics.published,
        dropped=metrics.sets_dropped,
        uptime_s=service.uptime_s,
        cameras=tuple(
            _camera(message, snapshot.cameras.get(message.camera)) for message in cameras
        ),
        outputs=_outputs(snapshot.outputs),
        calibration=_calibration(session),
        last_trouble=last_trouble,
        lost_reason=lost_reason_text(metrics.lost_reason),
        effort=metrics.effort.value,
        lag_median_ms=_finite(metrics.lag_ms.median),
        preparing=preparing,
        slowness=slowness_text(metrics.slowness),
    )


def starting_report(
    config: Config, outputs: OpenOutputs, last_trouble: Trouble | None, preparing: str = ""
) -> StatusReport:
    """The status during the preparation of the first session, with open outputs; `preparing`: its progress."""
    return StatusReport(
        version=mocapd.__version__,
        pid=os.getpid(),
        instance=outputs.instance,
        state_dir=str(config.state_dir.resolve()),
        state="starting",
        tracker=config.tracker.name,
        tracking=Tracking.LOST.value,
        rate_hz=0.0,
        latency_median_ms=None,
        latency_p95_ms=None,
        published=0,
        dropped=0,
        uptime_s=outputs.uptime_s,
        cameras=(),
        outputs=_outputs({sink.name: sink.status() for sink in outputs.sinks}),
        last_trouble=last_trouble,
        preparing=preparing,
    )


def _outputs(statuses: Mapping[str, SinkStatus]) -> tuple[OutputReport, ...]:
    return tuple(
        OutputReport(name, s.sent, s.refused, s.listeners, s.detail) for name, s in statuses.items()
    )


def _camera(message: CameraStatus, status: CaptureStatus | None) -> CameraStatusReport:
    is_silent = status is not None and status.is_silent
    return CameraStatusReport(
        id=message.camera,
        state=SILENT if is_silent else message.state,
        detail=message.detail,
        source=message.source,
        rate_hz=message.rate_hz,
        frames=message.frames,
        lost_frames=message.lost_frames,
        reopened=message.reopened,
        mounting=message.mounting,
    )


def _calibration(session: Session) -> CalibrationReport | None:
    if session.rig is None:
        return None
    return CalibrationReport(session.rig_source, _unix_s(session.calibrated))


def _unix_s(when: datetime | None) -> float | None:
    """A time without a zone is UTC, as `calibration.toml` has it."""
    if when is None:
        return None
    return (when if when.tzinfo else when.replace(tzinfo=UTC)).timestamp()


def _finite(value: float) -> float | None:
    return None if math.isnan(value) else value
