"""Pictures on demand: their layout, their size, what lies over them, and that nobody pays unasked."""

import json
import threading
from collections.abc import Iterator
from typing import Any

import cv2
import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection

from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.geometry.camera_model import project
from mocapd.types import Bytes, FrameSet
from mocapd.web.links.socket_link import MOST_HZ
from mocapd.web.server import WebServer
from tests.web.browser import PATIENCE_S, connect
from tests.web.tiny_host import BELOW_THE_HIPS, OVERLAY, TinyHost


class Pictures:
    """A page's connection for pictures."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket

    def ask(self, camera: str, **more: object) -> None:
        self.socket.send(json.dumps({"camera": camera, **more}))

    def answer(self) -> tuple[dict[str, Any], bytes]:
        """Header and JPEG."""
        data = self.socket.recv(PATIENCE_S)
        assert isinstance(data, bytes)
        length = int.from_bytes(data[:4], "little")
        return json.loads(data[4 : 4 + length]), data[4 + length :]

    def picture(self, camera: str, **more: object) -> tuple[dict[str, Any], bytes]:
        self.ask(camera, **more)
        return self.answer()


@pytest.fixture
def pictures(server: WebServer) -> Iterator[Pictures]:
    with connect(server, "/pictures") as socket:
        yield Pictures(socket)


other_pictures = pictures  # a second page


def decoded(jpeg: bytes) -> Bytes:
    pixels = cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR)
    assert pixels is not None
    return np.asarray(pixels, dtype=np.uint8)


def test_header_and_jpeg_in_one_message(host: TinyHost, pictures: Pictures) -> None:
    host.tracks = False
    host.show("cam1", 7, t_ns=123)
    header, jpeg = pictures.picture("cam1")
    assert header == {
        "camera": "cam1", "seq": 7, "t_ns": 123, "size_px": [640, 480], "shapes": [],
    }  # fmt: skip
    assert decoded(jpeg).shape == (360, 480, 3)
    assert decoded(jpeg).mean() == pytest.approx(7, abs=2)


@pytest.mark.parametrize(("asked", "got"), [(320, 320), (300, 320), (640, 640), (4000, 640)])
def test_as_wide_as_asked_but_no_wider_than_the_camera(
    host: TinyHost, pictures: Pictures, asked: int, got: int
) -> None:
    host.show("cam0", 1)
    _, jpeg = pictures.picture("cam0", width=asked)
    assert decoded(jpeg).shape[1] == got


def test_nothing_is_encoded_when_nobody_asks(
    host: TinyHost, server: WebServer, pictures: Pictures
) -> None:
    with connect(server, "/live") as live:  # looks, but at no picture
        for seq in range(20):
            host.show("cam0", seq)
        live.recv(PATIENCE_S)
        assert server.encoder.encoded == 0
        pictures.picture("cam0")
        assert server.encoder.encoded == 1


def jpeg_of(width: int, height: int) -> bytes:
    pixels = np.random.default_rng(7).integers(0, 256, (height, width, 3), dtype=np.uint8)
    return bytes(cv2.imencode(".jpg", pixels)[1])


@pytest.mark.parametrize("width", [640, 1280])
def test_the_cameras_own_jpeg_is_handed_on_as_it_is(
    host: TinyHost, server: WebServer, pictures: Pictures, width: int
) -> None:
    delivered = jpeg_of(640, 480)
    host.show("cam0", 1, encoded=delivered)
    header, jpeg = pictures.picture("cam0", width=width)
    assert header["size_px"] == [640, 480]
    assert jpeg == delivered
    assert server.encoder.encoded == 0


def test_a_smaller_picture_is_not_the_cameras_own(host: TinyHost, pictures: Pictures) -> None:
    host.show("cam0", 1, encoded=jpeg_of(640, 480))
    assert decoded(pictures.picture("cam0", width=320)[1]).shape == (240, 320, 3)


def without_tables(jpeg: bytes) -> bytes:
    """As some webcams send it: the usual Huffman tables are meant."""
    while (at := jpeg.find(b"\xff\xc4")) >= 0:
        jpeg = jpeg[:at] + jpeg[at + 2 + int.from_bytes(jpeg[at + 2 : at + 4], "big") :]
    return jpeg


@pytest.mark.parametrize(
    "encoded",
    [
        b"",
        b"<html><script>alert(1)</script>",
        jpeg_of(640, 481),
        jpeg_of(640, 480)[:200],
        without_tables(jpeg_of(640, 480)),
        bytes(cv2.imencode(".png", np.zeros((480, 640, 3), np.uint8))[1]),
    ],
    ids=["empty", "page", "other size", "cut", "without tables", "png"],
)
def test_what_a_browser_might_not_show_is_encoded_from_the_pixels(
    host: TinyHost, server: WebServer, pictures: Pictures, encoded: bytes
) -> None:
    host.show("cam0", 9, encoded=encoded)
    _, jpeg = pictures.picture("cam0", width=640)
    assert decoded(jpeg).mean() == pytest.approx(9, abs=2)
    assert server.encoder.encoded == 1


def test_two_pages_cost_one_encoding(
    host: TinyHost, server: WebServer, pictures: Pictures, other_pictures: Pictures
) -> None:
    host.show("cam0", 1)
    assert pictures.picture("cam0")[1] == other_pictures.picture("cam0")[1]
    assert server.encoder.encoded == 1


def test_a_picture_that_is_known_is_not_sent_again(host: TinyHost, pictures: Pictures) -> None:
    host.show("cam0", 1)
    first, _ = pictures.picture("cam0")
    pictures.ask("cam0", after=first["seq"])
    host.show("cam0", 2)
    assert pictures.answer()[0]["seq"] == 2


def test_cameras_do_not_wait_for_each_other(host: TinyHost, pictures: Pictures) -> None:
    host.show("cam1", 1)
    pictures.ask("cam0")  # has no picture
    pictures.ask("cam1")
    assert pictures.answer()[0]["camera"] == "cam1"
    header, jpeg = pictures.answer()
    assert header == {"camera": "cam0", "seq": None, "why": "no new picture"}
    assert jpeg == b""


def test_a_camera_that_does_not_exist_is_said_to(host: TinyHost, pictures: Pictures) -> None:
    assert pictures.picture("cam9")[0]["why"] == "no such camera now"
    host.hub = None  # they are being opened anew
    assert pictures.picture("cam0")[0]["why"] == "no such camera now"


def test_no_camera_is_encoded_faster_than_the_page_needs(
    host: TinyHost, pictures: Pictures
) -> None:
    stop = threading.Event()

    def film() -> None:
        seq = 0
        while not stop.wait(0.002):
            seq += 1
            host.show("cam0", seq)

    thread = threading.Thread(target=film)
    thread.start()
    headers = [pictures.picture("cam0")[0]]
    for _ in range(5):
        headers.append(pictures.picture("cam0", after=headers[-1]["seq"])[0])
    stop.set()
    thread.join()
    times_s = np.array([header["t_ns"] for header in headers]) / NS_PER_S
    assert np.diff(times_s).min() > 0.0
    # a slow machine makes them fewer, never more
    assert times_s[-1] - times_s[0] > 4 / MOST_HZ


def test_the_body_is_drawn_where_the_camera_sees_it(host: TinyHost, pictures: Pictures) -> None:
    frame = host.show("cam1", 1)
    all_shapes = pictures.picture("cam1")[0]["shapes"]
    shapes = [shape for shape in all_shapes if shape["kind"] == "line"]
    # nobody looks at the legs
    assert len(shapes) == len(host.skeleton.names) - len(BELOW_THE_HIPS) - 1
    assert {shape["style"] for shape in shapes} == {"bone", "hint"}
    found = host.body()
    assert found is not None
    assert found.body.joints_m is not None
    assert host.rig is not None
    seen_px = project(host.rig.cameras[1], np.delete(found.body.joints_m, BELOW_THE_HIPS, axis=0))
    drawn_px = np.array([point for shape in shapes for point in shape["at_px"]])
    # the body has moved a little since the picture was drawn
    assert np.allclose(drawn_px.mean(axis=0), seen_px.mean(axis=0), atol=60)
    assert frame.pixels.shape == (480, 640, 3)


def test_of_a_slow_tracker_the_picture_is_shown_that_its_pose_is_of(
    host: TinyHost, pictures: Pictures
) -> None:
    """Over a newer picture arms that move would be drawn where they were."""
    t_ns = monotonic_ns()
    tracked = host.show("cam0", 1, t_ns=t_ns)
    host.tracked = FrameSet(t_ns, {"cam0": tracked})
    host.show("cam0", 20, t_ns=t_ns + NS_PER_S)
    header, jpeg = pictures.picture("cam0")
    assert (header["seq"], header["t_ns"]) == (1, t_ns)
    assert header["shapes"]
    assert decoded(jpeg).mean() == pytest.approx(1, abs=2)


def test_over_a_picture_in_which_nobody_was_tracked_nothing_is_drawn(
    host: TinyHost, pictures: Pictures
) -> None:
    t_ns = monotonic_ns()
    host.tracked = FrameSet(t_ns, {"cam0": host.show("cam0", 1, t_ns=t_ns)})
    host.show("cam0", 200, t_ns=t_ns + 5 * NS_PER_S)  # the tracker hangs
    host.show("cam1", 7, t_ns=t_ns)  # takes no part in the pose
    for camera, seq in (("cam0", 200), ("cam1", 7)):
        header, _ = pictures.picture(camera)
        assert (header["seq"], header["shapes"]) == (seq, [])


def test_during_a_setup_the_steps_own_shapes_are_drawn(host: TinyHost, pictures: Pictures) -> None:
    host.setup()
    host.show("cam0", 1)
    assert pictures.picture("cam0")[0]["shapes"] == [
        {"kind": "text", "at_px": [[10.0, 40.0]], "style": OVERLAY.style, "text": OVERLAY.text}
    ]
    drawn = pictures.picture("cam0", over="body")[0]["shapes"]
    assert {shape["kind"] for shape in drawn} == {"line", "halo"}, (
        "the live view asks for the body all the same"
    )


@pytest.mark.parametrize("text", ["", "{}", '{"camera": "cam0", "width": 0}', '{"camera": 3}'])
def test_nonsense_ends_that_connection_only(
    host: TinyHost, pictures: Pictures, other_pictures: Pictures, text: str
) -> None:
    pictures.socket.send(text)
    with pytest.raises(ConnectionClosed):
        pictures.socket.recv(PATIENCE_S)
    host.show("cam0", 1)
    assert other_pictures.picture("cam0")[0]["seq"] == 1
