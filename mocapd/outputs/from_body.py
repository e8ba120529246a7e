"""From the tracker's body to the frame that is sent; on the latency path."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from mocapd.body.skeleton import local_from_global
from mocapd.outputs.wire import SCHEMA, Joint, SkeletonFrame
from mocapd.types import BodyState, Floats, Skeleton, Tracking

_DIGITS = 4  # of an uncertainty in metres; further digits are noise


def skeleton_frame(
    body: BodyState,
    skeleton: Skeleton,
    *,
    instance: str,
    seq: int,
    publish_monotonic_ns: int,
    unix_from_monotonic_ns: int,
) -> SkeletonFrame:
    """The body as sent; lost: no joints. A pure function: the caller reads the clock.

    `unix_from_monotonic_ns` is `mocapd.clock.unix_from_monotonic_ns()`; `publish_monotonic_ns` now.
    """
    return SkeletonFrame(
        schema=SCHEMA,
        instance=instance,
        person=0,  # the only one
        seq=seq,
        capture_monotonic_ns=body.t_ns,
        capture_unix_ns=body.t_ns + unix_from_monotonic_ns,
        publish_monotonic_ns=publish_monotonic_ns,
        tracker=body.tracker,
        tracking=body.tracking.value,
        cameras=body.cameras,
        joints=_joints(body, skeleton),
        smoothing_lag_ns=body.smoothing_lag_ns,
    )


def _joints(body: BodyState, skeleton: Skeleton) -> dict[str, Joint]:
    if body.tracking is Tracking.LOST or body.pose is None or body.joints_m is None:
        return {}
    local_xyzw = local_from_global(skeleton, body.pose.quats_xyzw)
    joints = map(
        Joint,
        _rows(body.joints_m, 3),
        _rows(body.pose.quats_xyzw, 4),
        _rows(local_xyzw, 4),
        body.confidence.tolist(),
        map(_finite, np.round(body.uncertainty_m, _DIGITS).tolist()),
    )
    return dict(zip(skeleton.names, joints, strict=True))


def _finite(number: float) -> float | None:
    return number if math.isfinite(number) else None


def _rows(array: Floats, n: int) -> Iterator[tuple[Any, ...]]:
    """The rows (J,n) as tuples of plain floats: msgspec encodes no numpy scalars."""
    numbers = iter(array.ravel().tolist())
    return zip(*[numbers] * n, strict=True)
