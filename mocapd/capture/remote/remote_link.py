"""The Zenoh session of one remote camera: its newest picture, and requests to its node."""

import json
import threading
from contextlib import ExitStack
from functools import partial

import msgspec
import zenoh

from mocapd.bus.zenoh_answers import limited_answers
from mocapd.bus.zenoh_calls import hold_session, zenoh_call
from mocapd.bus.zenoh_client_config import client_config
from mocapd.bus.zenoh_close import close_soon
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.arrival_limit import ArrivalLimit
from mocapd.capture.remote.camera_wire import M
from mocapd.capture.remote.clock_track import ClockTrack
from mocapd.capture.remote.picture_reader import Arrived
from mocapd.capture.remote.remote_address import RemoteAddress
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.errors import MalformedError, UnavailableError

_CONNECT_S = 1.0
_CLOSE_S = 0.05  # closing continues in the background: many cameras close together
_LOST_S = 1.0  # timeout of a clock request
_PING_NS = NS_PER_S // 4  # interval of clock requests
_UNSURE_PING_NS = NS_PER_S // 20  # the interval while the estimate is uncertain
_SURE_NS = 300_000


class RemoteLink:
    """Open from construction to `close`, which any thread may call and which wakes `newest`. `clock`: estimate from the
    answers to `ping`."""

    def __init__(self, address: RemoteAddress) -> None:
        """Raises UnavailableError without an answer from the endpoint."""
        self.clock = ClockTrack()
        self.run: int | None = None  # of the node, by its last answer
        self._address = address
        self._opened = ExitStack()
        self._asked_ns = 0
        self._changed = threading.Condition()  # guards what follows
        self._newest: Arrived | None = None
        self._gone = self._closed = False
        config = client_config(
            address.endpoint,
            timeout_s=_CONNECT_S,
            tls_root_ca=address.ca,
            user=address.user,
            password=address.password,
            certificate=address.certificate,
            private_key=address.private_key,
        )
        config["transport"]["link"]["rx"] = {"max_message_size": camera_wire.MOST_TOGETHER_BYTES}
        try:
            with zenoh_call():
                self._session = zenoh.open(zenoh.Config.from_json5(json.dumps(config)))
                hold_session(self._session)
        except zenoh.ZError:
            # a refused login looks like silence to Zenoh
            secrets = ", and user, password and certificates" if _has_secrets(address) else ""
            raise UnavailableError(
                "no camera node and no router answers",
                address.endpoint,
                f"start `mocapd camera-node` there; check host and port{secrets}",
            ) from None
        self._opened.enter_context(self._session)

    def listen(self, limit: ArrivalLimit) -> None:
        """Subscribes to pictures, within `limit`, and to the camera's liveliness. Raises UnavailableError."""
        pictures = camera_wire.picture(self._address.node, self._address.camera)
        token = camera_wire.alive(self._address.node, self._address.camera)
        try:
            with zenoh_call():
                # indirect=False: Zenoh would start a Python thread that blocks the interpreter's exit
                on_picture = zenoh.handlers.Callback(
                    partial(self._on_picture, limit), indirect=False
                )
                self._opened.enter_context(self._session.declare_subscriber(pictures, on_picture))
                on_liveliness = zenoh.handlers.Callback(self._on_liveliness, indirect=False)
                liveliness = self._session.liveliness()
                self._opened.enter_context(liveliness.declare_subscriber(token, on_liveliness))
        except zenoh.ZError:
            raise self._lost() from None

    def newest(self, timeout_s: float) -> Arrived | None:
        """Waits for the next picture, at most `timeout_s`. None after the timeout, `close`, or loss of the camera."""
        with self._changed:
            self._changed.wait_for(
                lambda: self._closed or self._gone or self._newest is not None, timeout_s
            )
            arrived, self._newest = self._newest, None
            return arrived

    @property
    def is_closed(self) -> bool:
        """Whether `close` was called."""
        return self._closed

    @property
    def is_gone(self) -> bool:
        """True after the node withdrew the camera's liveliness token."""
        return self._gone

    def ask(self, key: str, kind: type[M], order: msgspec.Struct | None, timeout_s: float) -> M:
        """The first answer. Raises UnavailableError without a valid one."""
        answers = self.ask_all(key, kind, order, timeout_s)
        if not answers:
            raise UnavailableError(
                "does not answer", self._address.place, "check that its node is running"
            )
        return answers[0]

    def ask_all(
        self, key: str, kind: type[M], order: msgspec.Struct | None, timeout_s: float
    ) -> list[M]:
        """All valid answers to a key. Raises UnavailableError if all answers are invalid."""
        payload = None if order is None else camera_wire.encode(order)
        try:
            with zenoh_call():
                samples = limited_answers(
                    self._session,
                    key,
                    timeout_s,
                    camera_wire.MOST_MESSAGE_BYTES,
                    payload=payload,
                    target=zenoh.QueryTarget.ALL,
                    # else Zenoh drops all but one answer of nodes with equal names
                    consolidation=zenoh.ConsolidationMode.NONE,
                )
        except zenoh.ZError:
            raise self._lost() from None
        understood: list[M] = []
        trouble: MalformedError | None = None
        for sample in samples:
            try:
                understood.append(camera_wire.decode(sample.payload.to_bytes(), kind))
            except MalformedError as error:
                trouble = error
        if understood or trouble is None:
            return understood
        raise UnavailableError(
            f"answers what is not understood: {trouble.what}",
            self._address.place,
            "bring node and daemon to the same version of mocapd",
        )

    def ping(self, answered: threading.Event | None = None) -> None:
        """Sends a clock request; its answer updates `clock`. Raises UnavailableError."""

        def on_reply(reply: zenoh.Reply) -> None:  # on Zenoh's thread
            came_ns = monotonic_ns()
            if reply.ok is not None and len(reply.ok.payload) <= camera_wire.MOST_MESSAGE_BYTES:
                self._add_clock_answer(asked_ns, reply.ok.payload.to_bytes(), came_ns)
            if answered is not None:
                answered.set()

        try:
            with zenoh_call():
                handler = zenoh.handlers.Callback(on_reply, indirect=False)
                asked_ns = monotonic_ns()
                self._session.get(camera_wire.clock(self._address.node), handler, timeout=_LOST_S)
        except zenoh.ZError:
            raise self._lost() from None

    def ping_if_due(self) -> None:
        """Sends a clock request when one is due, more often while the estimate is uncertain; call often. Raises
        UnavailableError."""
        line, now_ns = self.clock.line, monotonic_ns()
        is_sure = line is not None and line.uncertainty_ns < _SURE_NS
        if now_ns - self._asked_ns >= (_PING_NS if is_sure else _UNSURE_PING_NS):
            self._asked_ns = now_ns
            self.ping()

    def close(self) -> None:
        """Closes the session; returns within _CLOSE_S, idempotent."""
        with self._changed:
            was_closed, self._closed = self._closed, True
            self._newest = None
            self._changed.notify_all()
        if not was_closed:
            close_soon(self._opened, _CLOSE_S)

    def _on_picture(self, limit: ArrivalLimit, sample: zenoh.Sample) -> None:
        came_ns = monotonic_ns()
        stamp = sample.attachment
        if (
            stamp is None
            or len(stamp) > camera_wire.MOST_MESSAGE_BYTES
            or len(sample.payload) > camera_wire.MOST_PICTURE_BYTES
            or not limit.take(came_ns)  # by one thread: Zenoh delivers a key's samples in order
        ):
            return
        arrived = Arrived(sample.payload.to_bytes(), stamp.to_bytes(), came_ns)
        with self._changed:
            if not self._closed:
                self._newest = arrived
                self._changed.notify_all()

    def _on_liveliness(self, sample: zenoh.Sample) -> None:
        with self._changed:
            self._gone = sample.kind == zenoh.SampleKind.DELETE
            self._changed.notify_all()

    def _add_clock_answer(self, asked_ns: int, data: bytes, came_ns: int) -> None:
        try:
            answer = camera_wire.decode(data, camera_wire.ClockAnswer)
        except MalformedError:
            return  # counts as no answer: `RemoteSource` reports a missing clock
        if answer.run != self.run:
            self.run = answer.run
            self.clock.restart(came_ns)
        self.clock.add_answer(asked_ns, answer, came_ns)

    def _lost(self) -> UnavailableError:
        return UnavailableError(
            "the connection to its node is lost", self._address.place, "check the network"
        )


def _has_secrets(address: RemoteAddress) -> bool:
    return bool(address.user or address.ca) or not address.endpoint.startswith("tcp/")
