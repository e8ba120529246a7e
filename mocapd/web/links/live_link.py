"""The WebSocket `/live`: each new body, and figures once a second.

See live_json for the messages. From the page: {watch}: false when it is hidden; then it gets the
figures only, so that its plots have no gap.
"""

import asyncio

import msgspec
from starlette.websockets import WebSocket

from mocapd.types import BodyState, Rig, Skeleton
from mocapd.web.host import Host
from mocapd.web.links.socket_link import MOST_HZ, send_json, serve, understood
from mocapd.web.live_json import body_json, figures_json, scene_json

FIGURES_EVERY_S = 1.0

_Scene = tuple[tuple[str, ...], Rig | None, Skeleton | None]


class Watch(msgspec.Struct, frozen=True):
    """Whether the page is visible."""

    watch: bool


class LiveLink:
    """One browser window with the live view."""

    def __init__(self, socket: WebSocket, host: Host) -> None:
        self._socket, self._host = socket, host
        self._watched = asyncio.Event()
        self._watched.set()

    async def run(self) -> None:
        """Until the window leaves."""
        await serve(self._socket, self._figures(), self._bodies(), self._read_messages())

    async def _figures(self) -> None:
        while True:
            await send_json(self._socket, figures_json(self._host.snapshot()))
            await asyncio.sleep(FIGURES_EVERY_S)

    async def _bodies(self) -> None:
        last_scene: _Scene | None = None
        last_body: BodyState | None = None
        while True:
            await self._watched.wait()
            hub, found = self._host.hub, self._host.body()
            body, skeleton = (found.body, found.skeleton) if found is not None else (None, None)
            scene = (hub.names if hub is not None else ()), self._host.rig, skeleton
            if last_scene is None or _differ(scene, last_scene):
                last_scene = scene
                await send_json(self._socket, scene_json(*scene))
            if body is not None and body is not last_body:
                last_body = body
                await send_json(self._socket, body_json(body))
            await asyncio.sleep(1.0 / MOST_HZ)

    async def _read_messages(self) -> None:
        while True:
            if (await understood(self._socket, Watch)).watch:
                self._watched.set()
            else:
                self._watched.clear()


def _differ(one: _Scene, other: _Scene) -> bool:
    """Ignores bone lengths: the page draws joints."""
    names, parents = (s[2].names if s[2] else None for s in (one, other))
    return one[0] != other[0] or one[1] is not other[1] or names != parents
