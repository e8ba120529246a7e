"""The WebSocket `/frames`, for games in the browser: the wire's own messages as JSON, of each the `schema` says which.

First `mocapd.Skeleton.Rest.v1`, and again when it changes noticeably; then `mocapd.Skeleton.v1` as often as the
body changes. Both without the names of this machine and its cameras, which are no site's business.
"""

import asyncio
import itertools
from dataclasses import replace

from starlette.websockets import WebSocket

from mocapd.clock import monotonic_ns, unix_from_monotonic_ns
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_skeleton import is_noticeable, rest_skeleton
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from mocapd.pipeline.body_hub import BodySample
from mocapd.types import BodyState, Skeleton
from mocapd.web.host import Host
from mocapd.web.links import hear_nothing, send_json, serve

MOST_GAMES = 4  # of these WebSockets at once
NOBODY = ""  # in place of the instance
_LOOK_EVERY_S = 0.008


class FramesLink:
    """One page of an allowed site."""

    def __init__(self, socket: WebSocket, host: Host) -> None:
        self._socket, self._host = socket, host

    async def run(self) -> None:
        """Until it leaves, or says something."""
        await serve(self._socket, self._send(), hear_nothing(self._socket))

    async def _send(self) -> None:
        numbers = itertools.count()
        newest: BodyState | None = None
        told: Skeleton | None = None
        while True:
            found = self._host.body()
            if found is not None and found.body is not newest:
                newest = found.body
                if told is None or is_noticeable(told, found.skeleton):
                    told = found.skeleton
                    await send_json(self._socket, _rest(found))
                await send_json(self._socket, _frame(found, next(numbers)))
            await asyncio.sleep(_LOOK_EVERY_S)


def _frame(sample: BodySample, seq: int) -> SkeletonFrame:
    return skeleton_frame(
        replace(sample.body, cameras=()),
        sample.skeleton,
        instance=NOBODY,
        seq=seq,
        publish_monotonic_ns=monotonic_ns(),
        unix_from_monotonic_ns=unix_from_monotonic_ns(),
    )


def _rest(sample: BodySample) -> RestSkeleton:
    stature_m = sample.track.shape.stature_m
    return rest_skeleton(sample.skeleton, instance=NOBODY, stature_m=stature_m)
