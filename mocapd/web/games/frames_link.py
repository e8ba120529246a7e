"""The WebSocket `/frames`, for games in the browser: messages of the wire as JSON, distinguished by `schema`.

First `mocapd.Skeleton.Rest.v1`, and again when it changes noticeably; then `mocapd.Skeleton.v1` for each new body, and
`mocapd.Health.v1` when its `slowness` changes. For privacy, without the names of this machine, its cameras and outputs.

Flow control: the page answers each frame with its number, {seen}. For a slow page frames are skipped, so that none
accumulate in the sockets' buffers.
"""

import asyncio
from dataclasses import replace
from typing import Annotated

import msgspec
from msgspec import Meta
from starlette.websockets import WebSocket

from mocapd.clock import monotonic_ns, unix_from_monotonic_ns
from mocapd.outputs.from_body import skeleton_frame
from mocapd.outputs.from_skeleton import is_noticeable, rest_skeleton
from mocapd.outputs.messages import RestSkeleton
from mocapd.outputs.wire import SkeletonFrame
from mocapd.pipeline.body_hub import BodySample
from mocapd.service.health import health_message, slowness_text
from mocapd.types import BodyState, Skeleton
from mocapd.web.host import Host
from mocapd.web.links.socket_link import send_json, serve, understood

MOST_GAMES = 4  # of these WebSockets at once
UNREAD = 2  # unacknowledged frames of one page
ANONYMOUS = ""  # in place of the instance
_LOOK_EVERY_S = 0.008
_LOOK_AT_HEALTH_S = 1.0
_LONGEST_ANSWER = 100  # [bytes]


class Seen(msgspec.Struct, frozen=True):
    """The page has read this frame, and all before it."""

    seen: Annotated[int, Meta(ge=0, le=2**53)]


class FramesLink:
    """One page of an allowed site."""

    def __init__(self, socket: WebSocket, host: Host) -> None:
        self._socket, self._host = socket, host
        self._sent = self._read = 0  # frames

    async def run(self) -> None:
        """Serve until the page leaves, or sends an invalid message."""
        await serve(self._socket, self._send(), self._healths(), self._read_messages())

    async def _read_messages(self) -> None:
        while True:
            answer = await understood(self._socket, Seen, _LONGEST_ANSWER)
            self._read = max(self._read, min(answer.seen + 1, self._sent))

    async def _healths(self) -> None:
        said = ""
        while True:
            snapshot = self._host.snapshot()
            if snapshot is not None and slowness_text(snapshot.metrics.slowness) != said:
                health = health_message(ANONYMOUS, 0, 0, snapshot.metrics, {})
                said = health.slowness
                await send_json(self._socket, msgspec.structs.replace(health, pid=0))
            await asyncio.sleep(_LOOK_AT_HEALTH_S)

    async def _send(self) -> None:
        newest: BodyState | None = None
        sent: Skeleton | None = None
        while True:
            sample = self._host.body()
            is_behind = self._sent - self._read >= UNREAD
            if sample is not None and sample.body is not newest and not is_behind:
                newest = sample.body
                if sent is None or is_noticeable(sent, sample.skeleton):
                    sent = sample.skeleton
                    await send_json(self._socket, _rest(sample))
                frame = _frame(sample, self._sent)
                self._sent += 1
                await send_json(self._socket, frame)
            await asyncio.sleep(_LOOK_EVERY_S)


def _frame(sample: BodySample, seq: int) -> SkeletonFrame:
    return skeleton_frame(
        replace(sample.body, cameras=()),
        sample.skeleton,
        instance=ANONYMOUS,
        seq=seq,
        publish_monotonic_ns=monotonic_ns(),
        unix_from_monotonic_ns=unix_from_monotonic_ns(),
    )


def _rest(sample: BodySample) -> RestSkeleton:
    stature_m = sample.track.shape.stature_m
    return rest_skeleton(sample.skeleton, instance=ANONYMOUS, stature_m=stature_m)
