"""The Zenoh session of one remote camera: its newest picture, questions to its node, and the end of both."""

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
_CLOSE_S = 0.05  # the end is not waited for: many cameras end together
_LOST_S = 1.0  # after which an answer is not expected any more
_PING_NS = NS_PER_S // 4  # how often the other clock is asked
_UNSURE_PING_NS = NS_PER_S // 20  # the same while it is not known well: answers wait on their way
_SURE_NS = 300_000


class RemoteLink:
    """From its making to `close`, which any thread may call and which wakes `newest`. `clock`: what the answers to
    `ping` have told."""

    def __init__(self, address: RemoteAddress) -> None:
        """Raises UnavailableError when nobody answers there."""
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
        """From now on keep the newest picture, of at most so many a second, and notice when the camera goes. Raises
        UnavailableError."""
        pictures = camera_wire.picture(self._address.node, self._address.camera)
        token = camera_wire.alive(self._address.node, self._address.camera)
        try:
            with zenoh_call():
                # on Zenoh's own thread: the Python thread it would else start hinders the interpreter's exit
                arrived = zenoh.handlers.Callback(partial(self._arrived, limit), indirect=False)
                self._opened.enter_context(self._session.declare_subscriber(pictures, arrived))
                told = zenoh.handlers.Callback(self._told, indirect=False)
                liveliness = self._session.liveliness()
                self._opened.enter_context(liveliness.declare_subscriber(token, told))
        except zenoh.ZError:
            raise self._lost() from None

    def newest(self, timeout_s: float) -> Arrived | None:
        """The newest picture that was not fetched yet, waiting for it. None: none came, or see `is_over`."""
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
        """Whether the node has said that the camera is gone."""
        return self._gone

    def ask(self, key: str, kind: type[M], order: msgspec.Struct | None, timeout_s: float) -> M:
        """The answer. Raises UnavailableError when none comes, or none that is understood."""
        answers = self.ask_all(key, kind, order, timeout_s)
        if not answers:
            raise UnavailableError(
                "does not answer", self._address.place, "check that its node is running"
            )
        return answers[0]

    def ask_all(
        self, key: str, kind: type[M], order: msgspec.Struct | None, timeout_s: float
    ) -> list[M]:
        """What all who take this key answer. Whoever is not understood is left out, and told when nobody else is there:
        raises UnavailableError."""
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
                    # else of two that answer to one name the first is not heard of
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
        """Ask for the other clock; `clock` learns of the answer when it comes. Raises UnavailableError."""

        def came(reply: zenoh.Reply) -> None:  # on Zenoh's thread
            came_ns = monotonic_ns()
            if reply.ok is not None and len(reply.ok.payload) <= camera_wire.MOST_MESSAGE_BYTES:
                self._told_time(asked_ns, reply.ok.payload.to_bytes(), came_ns)
            if answered is not None:
                answered.set()

        try:
            with zenoh_call():
                handler = zenoh.handlers.Callback(came, indirect=False)
                asked_ns = monotonic_ns()
                self._session.get(camera_wire.clock(self._address.node), handler, timeout=_LOST_S)
        except zenoh.ZError:
            raise self._lost() from None

    def ping_if_due(self) -> None:
        """To be called often: asks for the other clock now and then, oftener while it is not known well. Raises
        UnavailableError."""
        line, now_ns = self.clock.line, monotonic_ns()
        is_sure = line is not None and line.uncertainty_ns < _SURE_NS
        if now_ns - self._asked_ns >= (_PING_NS if is_sure else _UNSURE_PING_NS):
            self._asked_ns = now_ns
            self.ping()

    def close(self) -> None:
        """Let go; never blocks for long, may be called twice."""
        with self._changed:
            was_closed, self._closed = self._closed, True
            self._newest = None
            self._changed.notify_all()
        if not was_closed:
            close_soon(self._opened, _CLOSE_S)

    def _arrived(self, limit: ArrivalLimit, sample: zenoh.Sample) -> None:
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

    def _told(self, sample: zenoh.Sample) -> None:
        with self._changed:
            self._gone = sample.kind == zenoh.SampleKind.DELETE
            self._changed.notify_all()

    def _told_time(self, asked_ns: int, data: bytes, came_ns: int) -> None:
        try:
            answer = camera_wire.decode(data, camera_wire.ClockAnswer)
        except MalformedError:
            return  # no answer: a node whose clock does not come is told by who needs it
        if answer.run != self.run:
            self.run = answer.run
            self.clock.restart(came_ns)
        self.clock.answered(asked_ns, answer, came_ns)

    def _lost(self) -> UnavailableError:
        return UnavailableError(
            "the connection to its node is lost", self._address.place, "check the network"
        )


def _has_secrets(address: RemoteAddress) -> bool:
    return bool(address.user or address.ca) or not address.endpoint.startswith("tcp/")
