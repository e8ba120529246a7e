"""A camera node in this process, and what a daemon on another machine has of it."""

import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass

import cv2
import numpy as np

from mocapd.capture.base import Source
from mocapd.capture.jpeg_picture import JpegPicture
from mocapd.capture.kinds.source_kinds import open_source
from mocapd.capture.pixels import frozen_pixels
from mocapd.capture.remote.remote_source import RemoteSource
from mocapd.capture.simulated.sim import SimSource
from mocapd.capture.source_request import SourceRequest
from mocapd.clock import monotonic_ns
from mocapd.config.node_params import Params
from mocapd.errors import CameraLost, UnavailableError
from mocapd.node.network_emulation import Imperfections
from mocapd.node.node_service import CameraNode
from mocapd.outputs.zenoh import zenoh_config
from mocapd.session.camera_inputs import CameraInput
from mocapd.types import Frame
from tests.capture.films import numbered_sim_film
from tests.outputs.frames import eventually, free_port
from tests.wizard.fake_webcam import FakeWebcam


class Pluggable:
    """A Source of 40 pictures a second that can be unplugged; it delivers pixels only, no JPEG."""

    recorded = False

    def __init__(self, name: str, size_px: tuple[int, int] = (64, 48)) -> None:
        self.name = name
        self.size_px = size_px
        self.plugged = True
        self.exposures_ns: list[int] = []
        self._closed = threading.Event()

    def open(self) -> None:
        if not self.plugged:
            raise UnavailableError("is not plugged in", self.name, "plug it in")
        self._closed.clear()

    def read(self) -> Frame:
        if self._closed.wait(0.025) or not self.plugged:
            raise CameraLost("was unplugged", self.name, "plug it in again")
        t_ns = monotonic_ns()
        self.exposures_ns.append(t_ns)
        pixels = np.full((self.size_px[1], self.size_px[0], 3), 90, np.uint8)
        pixels[:4, :4] = len(self.exposures_ns) % 250  # as no two pictures of a camera are the same
        return Frame(self.name, len(self.exposures_ns), t_ns, frozen_pixels(pixels))

    def close(self) -> None:
        self._closed.set()


class StreamingWebcam(FakeWebcam):
    """A webcam that can be set, and delivers."""

    pictures = 0

    def open(self) -> None:
        if not self.plugged:
            raise UnavailableError("is not plugged in", self.name, "plug it in")

    def read(self) -> Frame:
        threading.Event().wait(0.025)
        if not self.plugged:
            raise CameraLost("was unplugged", self.name, "plug it in again")
        t_ns = monotonic_ns()
        pixels = self.picture(t_ns)
        self.pictures += 1
        pixels[:8, :8] = self.pictures % 250  # as no two pictures of a camera are the same
        jpeg = cv2.imencode(".jpg", pixels)[1].tobytes()
        return Frame(self.name, 0, t_ns, JpegPicture(jpeg, frozen_pixels(pixels)))


@dataclass(frozen=True)
class Running:
    """A node and where it is."""

    node: CameraNode
    port: int

    def address(self, camera: str = "cam0", login: str = "") -> str:
        return f"zenoh://{login}127.0.0.1:{self.port}/{self.node.name}/{camera}"

    def source(
        self, camera: str = "cam0", login: str = "", size_px: tuple[int, int] | None = None
    ) -> RemoteSource:
        source = open_source(self.address(camera, login), SourceRequest("left", size_px))
        assert isinstance(source, RemoteSource)
        return source


@contextmanager
def running_node(
    *sources: Source,
    port: int = 0,
    params: Params | None = None,
    imperfections: Imperfections | None = None,
    **zenoh: object,
) -> Iterator[Running]:
    """Without sources it has one simulated webcam, cam0."""
    port = port or free_port()
    cameras: Sequence[Source] = sources or (SimSource(numbered_sim_film(), "cam0"),)
    node = CameraNode(
        "attic",
        zenoh_config.Params(port=port, **zenoh),  # type: ignore[arg-type]
        params or Params(),
        [CameraInput(one, "") for one in cameras],
        imperfections,
    )
    with node:
        over = threading.Event()

        def work() -> None:
            while not over.is_set() and not node.wait(0.2):
                pass

        thread = threading.Thread(target=work)
        thread.start()
        try:
            yield Running(node, port)
        finally:
            over.set()
            thread.join()


def opened(source: RemoteSource) -> RemoteSource:
    """Opened as a capture thread does: tried until it is there."""

    def tries() -> bool:
        try:
            source.open()
        except UnavailableError:
            return False
        return True

    assert eventually(tries)
    return source


def next_frame(source: RemoteSource) -> Frame:
    """The next one, also where this machine was too busy for a second to hand any out."""
    while True:
        try:
            return source.read()
        except CameraLost:
            opened(source)
