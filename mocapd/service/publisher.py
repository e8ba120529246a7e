"""Sends each body and state message to every output; frame numbers continue across sessions."""

import itertools
import math
from collections.abc import Callable, Sequence

from mocapd.clock import NS_PER_S, monotonic_ns, unix_from_monotonic_ns
from mocapd.errors import UnavailableError
from mocapd.outputs.base import Sink
from mocapd.outputs.facing import facing_yaw_rad
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_skeleton import is_noticeable, rest_skeleton
from mocapd.outputs.messages import Facing, StateMessage
from mocapd.outputs.wire import SkeletonFrame
from mocapd.pipeline.body_hub import BodySample
from mocapd.types import Skeleton, Tracking

LIVE = Tracking.LIVE.value
REST_EVERY_NS = NS_PER_S  # shortest interval of rest skeletons while the proportions are estimated


class Publisher:
    """A consumer of a BodyHub. `put` is called by one thread at a time, never during `begin`; `publish_state` and
    `recenter` are thread-safe."""

    def __init__(
        self, sinks: Sequence[Sink], instance: str, clock: Callable[[], int] = monotonic_ns
    ) -> None:
        self._sinks, self._instance, self._clock = tuple(sinks), instance, clock
        self._seq = itertools.count()
        self._newest: SkeletonFrame | None = None
        self._stature_m = 0.0
        self._sent_rest: Skeleton | None = None
        self._sent_rest_ns = 0

    def begin(self, skeleton: Skeleton, stature_m: float) -> None:
        """Begins a session with this wearer."""
        self._stature_m = stature_m
        self._send_rest(skeleton, self._clock())

    def put(self, sample: BodySample) -> None:
        """Sends the body, and the rest skeleton when it has changed noticeably."""
        now_ns = self._clock()
        frame = skeleton_frame(
            sample.body,
            sample.skeleton,
            instance=self._instance,
            seq=next(self._seq),
            publish_monotonic_ns=now_ns,
            unix_from_monotonic_ns=unix_from_monotonic_ns(),
        )
        self._newest = frame
        for sink in self._sinks:
            sink.send(frame)
        if now_ns - self._sent_rest_ns >= REST_EVERY_NS and (
            self._sent_rest is None or is_noticeable(self._sent_rest, sample.skeleton)
        ):
            self._send_rest(sample.skeleton, now_ns)

    def publish_state(self, message: StateMessage) -> None:
        """Sends a state message to every output."""
        for sink in self._sinks:
            sink.send_state(message)

    def recenter(self) -> Facing:
        """Defines the person's heading as forward, in every output. Raises UnavailableError without a live body."""
        frame = self._newest
        yaw_rad = facing_yaw_rad(frame) if frame is not None and frame.tracking == LIVE else None
        if frame is None or yaw_rad is None:
            raise UnavailableError(
                "no person in view whose heading could become forward",
                "the daemon",
                "stand where the cameras see you, look ahead, and repeat it",
            )
        facing = Facing(self._instance, frame.person, math.degrees(yaw_rad), frame.capture_unix_ns)
        self.publish_state(facing)
        return facing

    def _send_rest(self, skeleton: Skeleton, now_ns: int) -> None:
        self._sent_rest, self._sent_rest_ns = skeleton, now_ns
        self.publish_state(
            rest_skeleton(skeleton, instance=self._instance, stature_m=self._stature_m)
        )
