"""The WebSocket `/pictures`: the page requests each picture, so a slow page is never flooded.

PictureRequest, JSON: {camera, width, after, over}: width in px of the screen; after: `seq` of the last picture
it got, null at first; over: the overlay, `setup` (during a setup) or `body`. Answer, one
binary message: uint32 (little-endian) length of the header, the header {camera, seq, t_ns, size_px,
shapes} as JSON, the JPEG. No new frame within a second: `seq` is null, `why` says the reason, and
there is no JPEG.
"""

import asyncio
from collections.abc import Iterable
from typing import Annotated, Literal

import msgspec
from msgspec import Meta
from starlette.websockets import WebSocket

from mocapd.web.encoder import Picture, PictureEncoder
from mocapd.web.host import Host
from mocapd.web.links.socket_link import BadMessageError, send_bytes, serve, understood
from mocapd.web.shown_json import as_json
from mocapd.wizard.bone_shapes import bone_shapes
from mocapd.wizard.step import Shape
from mocapd.wizard.step_names import StepName

DEFAULT_WIDTH_PX = 480
MOST_UNDER_WAY = 32  # of one page
LONGEST_NAME = 4096  # of a camera; the longest name in our tests has 3000 characters
MOST_FRAMES = 2**63 - 1


class PictureRequest(msgspec.Struct, frozen=True):
    """A page's request."""

    camera: Annotated[str, Meta(max_length=LONGEST_NAME)]
    width: Annotated[int, Meta(ge=1, le=8192)] = DEFAULT_WIDTH_PX
    after: Annotated[int, Meta(ge=0, le=MOST_FRAMES)] | None = None
    over: Literal["setup", "body"] = "setup"


async def picture_link(socket: WebSocket, host: Host, encoder: PictureEncoder) -> None:
    """Answer requests until the page leaves; several at once, one for each camera."""

    async def answers() -> None:
        under_way = 0

        def on_done(_task: asyncio.Task[None]) -> None:
            nonlocal under_way
            under_way -= 1

        async with asyncio.TaskGroup() as group:
            while True:
                request = await understood(socket, PictureRequest)
                if under_way >= MOST_UNDER_WAY:
                    raise BadMessageError("more requests than cameras")
                under_way += 1
                group.create_task(_answer(socket, host, encoder, request)).add_done_callback(
                    on_done
                )

    await serve(socket, answers())


async def _answer(
    socket: WebSocket, host: Host, encoder: PictureEncoder, request: PictureRequest
) -> None:
    with_body = shows_body(host, request.over)
    picture = await encoder.picture(request.camera, request.width, request.after, with_body)
    if picture is None:
        hub = host.hub
        why = "no new picture" if hub and request.camera in hub.names else "no such camera now"
        await send_bytes(socket, message({"camera": request.camera, "seq": None, "why": why}, b""))
        return
    header = {
        "camera": picture.camera,
        "seq": picture.seq,
        "t_ns": picture.t_ns,
        "size_px": picture.size_px,
        "shapes": shapes_json(shapes_over(host, picture, with_body)),
    }
    await send_bytes(socket, message(header, picture.jpeg))


def shows_body(host: Host, over: str) -> bool:
    """True if the body is drawn: in the live view, and in the setup's step Check."""
    wizard = host.wizard if over == "setup" else None
    return wizard is None or wizard.view().step is StepName.CHECK


def shapes_over(host: Host, picture: Picture, with_body: bool) -> tuple[Shape, ...]:
    """The shapes of the body tracked in this picture, if any; without the body the overlays of the setup's step."""
    wizard = host.wizard
    if not with_body:
        view = None if wizard is None else wizard.view().view
        return () if view is None else view.overlays.get(picture.camera, ())
    rig, sample = host.rig, picture.body
    cameras = {camera.name: camera for camera in rig.cameras} if rig is not None else {}
    if sample is None or picture.camera not in cameras:
        return ()
    return bone_shapes(cameras[picture.camera], sample.body, sample.skeleton)


def message(header: object, jpeg: bytes) -> bytes:
    """One binary message; see the module's docstring."""
    encoded = as_json(header)
    return len(encoded).to_bytes(4, "little") + encoded + jpeg


def shapes_json(shapes: Iterable[Shape]) -> list[dict[str, object]]:
    """The shapes in the page's format, rounded to a tenth of a pixel."""
    return [
        {
            "kind": shape.kind,
            "at_px": [(round(float(x), 1), round(float(y), 1)) for x, y in shape.at_px],
            "style": shape.style,
            "text": shape.text,
        }
        | ({"radii_px": [round(radius, 1) for radius in shape.radii_px]} if shape.radii_px else {})
        for shape in shapes
    ]
