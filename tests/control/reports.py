"""An answer of `mocapd status`, for tests to change."""

from typing import Any

import msgspec

from mocapd.control.control_messages import (
    CalibrationReport,
    CameraStatusReport,
    OutputReport,
    StatusReport,
)

CAMERA = CameraStatusReport(
    id="left",
    state="live",
    detail="",
    source="usb:1-3:046d:0825:",
    rate_hz=29.97,
    frames=1000,
    lost_frames=0,
    reopened=0,
    mounting="steady",
)
OUTPUT = OutputReport("zenoh", 990, 10, 1, "game (pid 12)")


def report(**changed: Any) -> StatusReport:
    """Of a daemon that tracks, with these fields changed."""
    usual = StatusReport(
        version="1.0",
        pid=4242,
        instance="pc",
        state_dir="/home/me/.local/state/mocapd",
        state="tracking",
        tracker="shirt+clothes",
        tracking="live",
        rate_hz=29.97,
        latency_median_ms=21.4,
        latency_p95_ms=33.6,
        published=990,
        dropped=10,
        uptime_s=3.0 * 3600 + 12 * 60,
        cameras=(CAMERA,),
        outputs=(OUTPUT,),
        calibration=CalibrationReport("/home/me/calibration.toml", 1_000_000.0),
    )
    return msgspec.structs.replace(usual, **changed)
