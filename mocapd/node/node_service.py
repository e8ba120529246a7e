"""The composition of a camera node: a Zenoh session, its clock, and its cameras."""

import logging
import secrets
import time
from collections.abc import Sequence
from contextlib import ExitStack
from typing import Self

import zenoh

from mocapd.bus.zenoh_close import close_soon
from mocapd.bus.zenoh_linger import close_at_once
from mocapd.capture.camera_thread.suspension import SuspensionWatch
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import MOST_NAME, CameraState, ClockAnswer
from mocapd.capture.webcam.plug_events import PlugEvents
from mocapd.clock import monotonic_ns
from mocapd.config.node_params import Params
from mocapd.errors import ConfigError
from mocapd.latch import EndLatch
from mocapd.node.network_emulation import Imperfections, LossyLink, NetworkLink
from mocapd.node.node_access import check_pairing, node_session_config, takes_orders
from mocapd.node.node_camera import NodeCamera
from mocapd.outputs.instance import chunk, instance_name
from mocapd.outputs.zenoh import zenoh_config
from mocapd.outputs.zenoh.zenoh_open import open_session
from mocapd.outputs.zenoh.zenoh_warnings import warnings
from mocapd.session.camera_inputs import CameraInput

_log = logging.getLogger(__name__)

HEARTBEAT_S = 0.1  # interval of updating the cameras' liveliness [s]
_STOP_S = 1.4


class CameraNode:
    """Runs as context manager; its owner calls `wait`. `end` and `died` are thread-safe."""

    def __init__(
        self,
        name: str,
        zenoh_params: zenoh_config.Params,
        params: Params,
        cameras: Sequence[CameraInput],
        imperfections: Imperfections | None = None,
    ) -> None:
        """name: in the keys; the machine's when empty. Raises ConfigError."""
        check_pairing(zenoh_params, params)
        self.name = instance_name(name)
        _check_names(self.name, [camera.source.name for camera in cameras])
        self._zenoh, self._params = zenoh_params, params
        self._imperfections = imperfections or Imperfections()
        is_emulated = imperfections is not None
        self._out, self._in = (
            LossyLink(self._imperfections) if is_emulated else NetworkLink() for _ in range(2)
        )
        self._run = secrets.randbits(48)
        self._plugs, self._suspension = PlugEvents(self._look_again), SuspensionWatch()
        self._opened = ExitStack()
        self._over = EndLatch()
        self.cameras = tuple(
            NodeCamera(
                self.name,
                self._run,
                camera,
                takes_orders(params),
                params.jpeg_quality,
                self._imperfections,
                self._out,
                self.died,
            )
            for camera in cameras
        )

    def __enter__(self) -> Self:
        for text in warnings(self._zenoh):
            _log.warning("%s", text)
        config = node_session_config(self._zenoh, self._params, self.name)
        session = self._opened.enter_context(open_session(self._zenoh, config))
        self._opened.enter_context(close_at_once(session))
        handler = zenoh.handlers.Callback(self._answer_clock, indirect=False)
        self._opened.enter_context(session.declare_queryable(camera_wire.clock(self.name), handler))
        for camera in self.cameras:
            camera.start(session, self._opened)
        self._plugs.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._plugs.stop()
        for camera in self.cameras:
            camera.let_go()
        until_s = time.monotonic() + _STOP_S
        for camera in self.cameras:
            camera.stop(max(0.0, until_s - time.monotonic()))
        for link in (self._in, self._out):
            link.close()
        close_soon(self._opened)

    def wait(self, timeout_s: float) -> bool:
        """Runs for `timeout_s` [s]; True when the node is over, after `end` or the end of every recording. Raises the
        MocapdError that ended a thread, or ThreadDiedError."""
        until_s = time.monotonic() + timeout_s
        while not self._over.wait(HEARTBEAT_S):
            slept_s = self._suspension.slept_s()
            for camera in self.cameras:
                if slept_s:
                    camera.renew(f"the machine has slept for {slept_s:.0f} s")
                camera.update_liveliness()
            if all(camera.is_over for camera in self.cameras):
                self._over.set()
            if time.monotonic() > until_s:
                break
        return self._over.is_set()

    def end(self) -> None:
        """Makes `wait` return."""
        self._over.set()

    def died(self, error: BaseException) -> None:
        """Ends the node after the unexpected end of a thread."""
        self._over.died(error)

    def states(self) -> tuple[CameraState, ...]:
        return tuple(camera.state for camera in self.cameras)

    def addresses(self) -> tuple[str, ...]:
        """Addresses for `source` in the daemon's configuration; the user completes the host, which the node may not know."""
        endpoint = (*self._zenoh.connect, *zenoh_config.listen_endpoints(self._zenoh))[0]
        protocol, _, place = zenoh_config.without_options(endpoint).partition("/")
        scheme = "zenohs" if protocol in zenoh_config.ENCRYPTED else "zenoh"
        login = (
            f"{self._params.paired_user or 'USER'}:PASSWORD@" if self._zenoh.password_file else ""
        )
        host, _, port = place.rpartition(":")
        if host in ("0.0.0.0", "[::]"):
            host = "THIS_MACHINE"
        return tuple(
            f"{scheme}://{login}{host}:{port}/{self.name}/{camera.name}" for camera in self.cameras
        )

    def _look_again(self) -> None:
        for camera in self.cameras:
            camera.look_again()

    def _answer_clock(self, query: zenoh.Query) -> None:
        def answer() -> None:
            taken_ns = self._imperfections.node_ns(monotonic_ns())
            answered_ns = self._imperfections.node_ns(monotonic_ns())
            data = camera_wire.encode(ClockAnswer(self._run, taken_ns, answered_ns))
            self._out.send(lambda: _reply(query, camera_wire.clock(self.name), data))

        self._in.send(answer)


def _check_names(node: str, cameras: Sequence[str]) -> None:
    """Raises ConfigError for cameras with equal keys, or a name that is too long."""
    by_key: dict[str, str] = {}
    for name in cameras:
        other = by_key.setdefault(chunk(name), name)
        if other != name:
            raise ConfigError(
                f"{other!r} and {name!r} are both {chunk(name)!r} in the keys",
                *("camera", "rename one of them: letters, digits, _ . and - stay as they are"),
            )
    for where, name in (("instance", node), *(("camera", key) for key in by_key)):
        if len(name) > MOST_NAME:
            raise ConfigError(f"{name!r} is too long", where, f"{MOST_NAME} characters at most")


def _reply(query: zenoh.Query, key: str, data: bytes) -> None:
    with query:
        query.reply(key, data, encoding=camera_wire.ENCODING)
