"""JSON messages for the live view: scene, body and figures."""

from collections.abc import Mapping
from dataclasses import asdict
from math import isfinite

import numpy as np

from mocapd.calibrate.bump.bump_watch import Mounting
from mocapd.geometry.camera_model import centre, rays
from mocapd.service.health import effort_text, lost_reason_text, slowness_text
from mocapd.service.service import Snapshot
from mocapd.types import BodyState, Camera, Rig, Skeleton

FRUSTUM_M = 0.35  # length of a drawn camera frustum [m]


def scene_json(
    names: tuple[str, ...], rig: Rig | None, skeleton: Skeleton | None
) -> dict[str, object]:
    """The slowly changing part. names: of the pictures; cameras: of the rig, with centre and the four corners of the
    frustum [m, world]; joints and parents: the skeleton's."""
    return {
        "kind": "scene",
        "names": list(names),
        "cameras": [_camera_json(camera) for camera in (rig.cameras if rig else ())],
        "joints": list(skeleton.names) if skeleton else [],
        "parents": skeleton.parents.tolist() if skeleton else [],
    }


def _camera_json(camera: Camera) -> dict[str, object]:
    w, h = camera.size_px
    corners_px = np.array([[0, 0], [w - 1, 0], [w - 1, h - 1], [0, h - 1]], dtype=float)
    _, directions = rays(camera, corners_px)
    corners_m = centre(camera) + FRUSTUM_M * directions
    return {
        "name": camera.name,
        "centre_m": np.round(centre(camera), 3).tolist(),
        "corners_m": np.round(corners_m, 3).tolist(),
    }


def body_json(body: BodyState) -> dict[str, object]:
    """The body now; joints_m [m, world] is null when it is lost, an uncertainty_m [m] where it is unknown."""
    return {
        "kind": "body",
        "tracking": body.tracking.value,
        "tracker": body.tracker,
        "joints_m": np.round(body.joints_m, 3).tolist() if body.joints_m is not None else None,
        "confidence": np.round(body.confidence, 2).tolist(),
        "uncertainty_m": [
            round(sd_m, 3) if isfinite(sd_m) else None for sd_m in body.uncertainty_m.tolist()
        ],
    }


def figures_json(snapshot: Snapshot | None) -> dict[str, object]:
    """State of cameras, tracker and outputs; `figures` is null when nothing tracks."""
    if snapshot is None:
        return {"kind": "figures", "figures": None}
    metrics = snapshot.metrics
    figures: Mapping[str, object] = {
        "tracker": metrics.tracker,
        "tracking": metrics.tracking.value,
        "lost_reason": lost_reason_text(metrics.lost_reason),
        "effort": effort_text(metrics.effort.value),
        "slowness": slowness_text(metrics.slowness),
        "preparing": snapshot.preparing,
        "rate_hz": metrics.rate_hz,
        "published": metrics.published,
        "sets_made": metrics.sets_made,
        "sets_dropped": metrics.sets_dropped,
        "latency_ms": asdict(metrics.latency_ms),
        "lag_ms": asdict(metrics.lag_ms),
        "step_ms": asdict(metrics.step_ms),
        "spread_ms": asdict(metrics.spread_ms),
        "cameras": [
            {
                "name": name,
                "state": status.state.value,
                "bumped": snapshot.mountings.get(name) is Mounting.BUMPED,
                "swapped": snapshot.mountings.get(name) is Mounting.SWAPPED,
                "reason": status.reason,
                "fps_hz": status.fps_hz,
                "frames": status.frames,
                "torn": status.torn,
                "reopens": status.reopens,
            }
            for name, status in snapshot.cameras.items()
        ],
        "outputs": [{"name": name, **asdict(status)} for name, status in snapshot.outputs.items()],
    }
    return {"kind": "figures", "figures": figures}
