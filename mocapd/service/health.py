"""Builds the state messages, which late joiners query, from the state of threads and sinks."""

import math
import os
from collections.abc import Mapping
from types import MappingProxyType

import mocapd
from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.messages import CameraStatus, Health, OutputHealth
from mocapd.pipeline.metrics import CameraMetrics, Metrics
from mocapd.pipeline.slowness import Slowness
from mocapd.session.camera_inputs import CameraInput
from mocapd.tracking.base import LostReason
from mocapd.tracking.effort import Effort

# by effort: the trouble and its fix
EFFORT_TROUBLE: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        Effort.SAVING.value: (
            "saving effort: this machine is too slow for this frame rate, so poses are less exact",
            "close other programs, or lower fps_hz of the cameras",
        ),
        Effort.LEAST.value: (
            "least effort: this machine is much too slow for this frame rate, so poses are clearly less exact",
            "close other programs, lower fps_hz of the cameras, or use a faster machine",
        ),
    }
)


def health_message(
    instance: str,
    started_unix_ns: int,
    now_unix_ns: int,
    metrics: Metrics,
    outputs: dict[str, SinkStatus],
    detail: str = "",
) -> Health:
    """The daemon's health; figures without a measurement are 0."""
    return Health(
        instance=instance,
        version=mocapd.__version__,
        pid=os.getpid(),
        started_unix_ns=started_unix_ns,
        now_unix_ns=now_unix_ns,
        tracker=metrics.tracker,
        tracking=metrics.tracking.value,
        rate_hz=metrics.rate_hz,
        latency_median_ms=_number(metrics.latency_ms.median),
        latency_p95_ms=_number(metrics.latency_ms.p95),
        frame_sets=metrics.sets_made,
        dropped=metrics.sets_dropped,
        outputs=tuple(
            OutputHealth(name, s.sent, s.refused, s.listeners, s.detail)
            for name, s in outputs.items()
        ),
        detail=detail
        or slowness_text(metrics.slowness)
        or lost_reason_text(metrics.lost_reason)
        or effort_text(metrics.effort.value),
        effort=metrics.effort.value,
        slowness=slowness_text(metrics.slowness),
    )


def lost_reason_text(reason: LostReason | None) -> str:
    """One line for people; empty for none."""
    return "" if reason is None else f"{reason.what} -- {reason.fix}"


def slowness_text(slowness: Slowness | None) -> str:
    """One line for people; empty while the tracker keeps up."""
    return "" if slowness is None else f"{slowness.what} -- {slowness.fix}"


def effort_text(effort: str) -> str:
    """One line for people; empty for the full effort."""
    trouble = EFFORT_TROUBLE.get(effort)
    return "" if trouble is None else " -- ".join(trouble)


def lost_frames(metrics: CameraMetrics | None, status: CaptureStatus) -> int:
    """Frames lost on the way, or damaged. A damaged one is a gap in the numbers, too, but before a whole frame follows it
    is counted by its source alone."""
    return max(0 if metrics is None else metrics.counts.lost, status.torn)


def camera_message(
    instance: str,
    camera: CameraInput,
    status: CaptureStatus,
    metrics: CameraMetrics,
    mounting: Mounting,
) -> CameraStatus:
    return CameraStatus(
        instance=instance,
        camera=status.camera,
        state=status.state.wire_name,
        detail=status.trouble,
        source=camera.spec,
        identity=camera.identity,
        size_px=camera.size_px,
        rate_hz=status.fps_hz,
        frames=status.frames,
        lost_frames=lost_frames(metrics, status),
        reopened=status.reopens,
        mounting=mounting.value,
    )


def gone_message(instance: str, name: str, camera: CameraInput) -> CameraStatus:
    """The last status of a camera that is no longer configured."""
    return CameraStatus(
        instance=instance,
        camera=name,
        state=CaptureState.ENDED.wire_name,
        detail="no longer configured",
        source=camera.spec,
        identity="",
        size_px=camera.size_px,
        rate_hz=0.0,
        frames=0,
        lost_frames=0,
        reopened=0,
    )


def _number(value: float) -> float:
    return 0.0 if math.isnan(value) else value
