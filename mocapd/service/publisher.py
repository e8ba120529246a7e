"""From the newest body to every output: frames numbered on from session to session, and state told."""

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
REST_EVERY_NS = NS_PER_S  # at the soonest, while the body's proportions are learned


class Publisher:
    """Takes what is put in a BodyHub. `put` is called by one thread at a time, `begin` while none does; `tell`
    and `recenter` by any."""

    def __init__(
        self, sinks: Sequence[Sink], instance: str, clock: Callable[[], int] = monotonic_ns
    ) -> None:
        self._sinks, self._instance, self._clock = tuple(sinks), instance, clock
        self._seq = itertools.count()
        self._newest: SkeletonFrame | None = None
        self._stature_m = 0.0
        self._told: Skeleton | None = None
        self._told_ns = 0

    def begin(self, skeleton: Skeleton, stature_m: float) -> None:
        """A session begins, with this wearer."""
        self._stature_m = stature_m
        self._tell_rest(skeleton, self._clock())

    def put(self, sample: BodySample) -> None:
        """Send the body, and the rest skeleton where the one that was told no longer does."""
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
        if now_ns - self._told_ns >= REST_EVERY_NS and (
            self._told is None or is_noticeable(self._told, sample.skeleton)
        ):
            self._tell_rest(sample.skeleton, now_ns)

    def tell(self, message: StateMessage) -> None:
        """Tell every output."""
        for sink in self._sinks:
            sink.send_state(message)

    def recenter(self) -> Facing:
        """Tell every output that the person faces forward now. Raises UnavailableError when it is not seen."""
        frame = self._newest
        yaw_rad = facing_yaw_rad(frame) if frame is not None and frame.tracking == LIVE else None
        if frame is None or yaw_rad is None:
            raise UnavailableError(
                "nobody is seen whose forward could be told",
                "the daemon",
                "stand where the cameras see you, look ahead, and say it again",
            )
        facing = Facing(self._instance, frame.person, math.degrees(yaw_rad), frame.capture_unix_ns)
        self.tell(facing)
        return facing

    def _tell_rest(self, skeleton: Skeleton, now_ns: int) -> None:
        self._told, self._told_ns = skeleton, now_ns
        self.tell(rest_skeleton(skeleton, instance=self._instance, stature_m=self._stature_m))
