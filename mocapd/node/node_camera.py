"""One camera of a node: sends the newest picture as the camera's JPEG, or encodes it once."""

import threading
from collections.abc import Callable
from contextlib import ExitStack

import cv2
import zenoh

from mocapd.capture.camera_thread.capture_status import CaptureState
from mocapd.capture.camera_thread.thread import CaptureThread
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.camera_wire import CameraState, PictureStamp
from mocapd.capture.webcam.control_lock import Lockable
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.node.network_emulation import Imperfections, NetworkLink
from mocapd.node.node_controls import ControlOrders
from mocapd.outputs.instance import chunk
from mocapd.pipeline.latest import Latest
from mocapd.session.camera_inputs import CameraInput
from mocapd.types import Frame

_SUBSCRIBED_NS = NS_PER_S // 10  # lifetime of the cached answer whether a subscriber exists
_REASON = 400  # characters


class NodeCamera:
    """The owner calls `start`, `update_liveliness` and `stop`; the rest is thread-safe.

    Without a subscriber nothing is encoded or sent. `sent` counts pictures passed to Zenoh; name: as in the keys.
    """

    def __init__(
        self,
        node: str,
        run: int,
        camera: CameraInput,
        can_set: bool,
        quality: int,
        imperfections: Imperfections,
        link: NetworkLink,
        died: Callable[[BaseException], None],
    ) -> None:
        """can_set: whether a client may set the camera; link: carries its messages."""
        self.name = chunk(camera.source.name)
        self.sent = 0
        self._node, self._run, self._quality = node, run, quality
        self._imperfections, self._link, self._died = imperfections, link, died
        self._newest: Latest[Frame] = Latest()
        self._size_px = camera.size_px
        self._capture = CaptureThread(camera.source, self, died, camera.expected_hz)
        source = camera.source
        self.controls = ControlOrders(source) if can_set and isinstance(source, Lockable) else None
        self._thread = threading.Thread(target=self._work, name=f"send-{self.name}", daemon=True)
        self._session: zenoh.Session | None = None
        self._publisher: zenoh.Publisher | None = None
        self._token: zenoh.LivelinessToken | None = None
        self._subscribed_until_ns = 0

    def start(self, session: zenoh.Session, opened: ExitStack) -> None:
        """Starts in this session, until `opened` is closed."""
        self._session = session
        self._publisher = opened.enter_context(
            session.declare_publisher(
                camera_wire.picture(self._node, self.name),
                encoding=zenoh.Encoding.IMAGE_JPEG,
                # a late picture is worthless: drop it, never wait
                congestion_control=zenoh.CongestionControl.DROP,
                priority=zenoh.Priority.INTERACTIVE_LOW,
                express=True,
            )
        )
        opened.callback(self._undeclare)
        handler = zenoh.handlers.Callback(self._answer, indirect=False)
        key = camera_wire.state(self._node, self.name)
        opened.enter_context(session.declare_queryable(key, handler))
        if self.controls is not None:
            self.controls.attach(
                session, camera_wire.control(self._node, self.name), opened, self._died
            )
        self._thread.start()
        self._capture.start()

    def put(self, frame: Frame) -> None:
        """See Mailbox."""
        self._size_px = frame.size_px
        self._newest.put(frame)

    def look_again(self) -> None:
        """Ends the pause before reopening, as some camera was plugged in."""
        self._capture.look_again()

    def renew(self, why: str) -> None:
        """Reopens the camera although it has not failed."""
        self._capture.renew(why)

    def update_liveliness(self) -> None:
        """Declares the liveliness token while the camera delivers; runs its watchdog. Call several times a second."""
        self._capture.watch()
        session, status = self._session, self._capture.status()
        if session is None:
            return
        is_live = status.state is CaptureState.LIVE and not status.is_silent
        if is_live and self._token is None:
            key = camera_wire.alive(self._node, self.name)
            self._token = session.liveliness().declare_token(key)
        elif not is_live:
            self._undeclare()

    @property
    def state(self) -> CameraState:
        status = self._capture.status()
        return CameraState(
            node=self._node,
            camera=self.name,
            state="lost" if status.is_silent else status.state.wire_name,  # type: ignore[arg-type]
            reason=status.trouble[:_REASON],
            size_px=self._size_px,
            rate_hz=min(status.fps_hz, 1e4),
            can_set=self.controls is not None,
            run=self._run,
        )

    @property
    def is_over(self) -> bool:
        """True for a recording that has ended."""
        return self._capture.status().state is CaptureState.ENDED

    def let_go(self) -> None:
        """First phase of stopping; never blocks."""
        self._session = None
        self._capture.let_go()
        self._newest.close()

    def stop(self, timeout_s: float) -> None:
        """Joins its threads, for at most `timeout_s` [s]."""
        self._capture.stop(timeout_s)
        if self._thread.ident is not None:
            self._thread.join(0.2)

    def _undeclare(self) -> None:
        token, self._token = self._token, None
        if token is not None:
            token.undeclare()  # type: ignore[no-untyped-call]

    def _work(self) -> None:
        try:
            while not self._newest.closed:
                frame = self._newest.get()
                if frame is not None and self._has_subscriber():
                    self._send(frame)
        except BaseException as error:  # reported to the owner
            self._died(error)
            raise

    def _has_subscriber(self) -> bool:
        now_ns, publisher = monotonic_ns(), self._publisher
        if now_ns < self._subscribed_until_ns:
            return True
        if publisher is None or not publisher.matching_status.matching:  # type: ignore[attr-defined]
            return False
        self._subscribed_until_ns = now_ns + _SUBSCRIBED_NS
        return True

    def _send(self, frame: Frame) -> None:
        data = frame.encoded
        if data is None:
            good, file = cv2.imencode(
                ".jpg", frame.pixels, [cv2.IMWRITE_JPEG_QUALITY, self._quality]
            )
            assert good
            data = file.tobytes()
        exposure_ns = self._imperfections.node_ns(frame.t_ns)
        stamp = camera_wire.encode(PictureStamp(self._run, frame.seq, exposure_ns))
        publisher = self._publisher
        if publisher is None:
            return
        self._link.send(lambda: publisher.put(data, attachment=stamp))
        self.sent += 1

    def _answer(self, query: zenoh.Query) -> None:
        with query:
            query.reply(
                camera_wire.state(self._node, self.name),
                camera_wire.encode(self.state),
                encoding=camera_wire.ENCODING,
            )
