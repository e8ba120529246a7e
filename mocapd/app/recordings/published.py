"""Subscribes to everything that a running daemon publishes, through a long queue that avoids losses."""

import queue
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Self

import zenoh

from mocapd.bus.zenoh_answers import MOST_ANSWERS_BYTES, limited_answers
from mocapd.bus.zenoh_calls import zenoh_call
from mocapd.client import Link, connect
from mocapd.errors import ConfigError, InputError
from mocapd.outputs import wire
from mocapd.outputs.messages import (
    CALIBRATION,
    REST_SKELETON,
    CalibrationInfo,
    RestSkeleton,
    decode_rest_skeleton,
)
from mocapd.outputs.wire import SkeletonFrame, decode_message
from mocapd.outputs.zenoh import keys

MOST_WAITING = 6000  # frames: 100 s at 60 Hz, should the disk stand still
ASK_S = 2.0  # timeout of querying the current state [s]


@dataclass(frozen=True, slots=True)
class Published:
    """One message; `payload` and `mime` as received."""

    message: SkeletonFrame | RestSkeleton | CalibrationInfo
    payload: bytes
    mime: str


class PublishedStream:
    """Subscribed from `__enter__` to `__exit__`. `dropped`: messages lost to a full queue; `refused`: damaged messages or
    other versions."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._waiting: queue.Queue[tuple[bytes, str]] = queue.Queue(MOST_WAITING)
        self._opened = ExitStack()
        self.instance = ""
        self.dropped = self.refused = 0

    def __enter__(self) -> Self:
        """Raises UnavailableError when no daemon is found in time, ConfigError when several are."""
        session = self._opened.enter_context(connect(self._link))
        try:
            self.instance = _only_instance(session, self._link)
            with zenoh_call():
                # states first: the writer needs them for frames
                for key in (
                    keys.rest_skeleton(self.instance, keys.ANY),
                    keys.calibration(self.instance),
                ):
                    self._subscribe(session, key)
                    for sample in limited_answers(session, key, ASK_S, MOST_ANSWERS_BYTES):
                        self._on_sample(sample)
                self._subscribe(session, keys.skeleton(self.instance, keys.ANY))
        except BaseException:
            self._opened.close()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        with zenoh_call():
            self._opened.close()

    def _subscribe(self, session: zenoh.Session, key: str) -> None:
        # on Zenoh's own thread, as in `client.astream`
        handler = zenoh.handlers.Callback(self._on_sample, indirect=False)
        self._opened.enter_context(session.declare_subscriber(key, handler))

    def _on_sample(self, sample: zenoh.Sample) -> None:
        try:
            self._waiting.put_nowait((sample.payload.to_bytes(), str(sample.encoding)))
        except queue.Full:
            self.dropped += 1

    def next(self, timeout_s: float) -> Published | None:
        """The next message in order of arrival; None after the timeout or for an invalid message."""
        try:
            payload, encoding = self._waiting.get(timeout=timeout_s)
        except queue.Empty:
            return None
        mime, _, schema = encoding.partition(";")
        decode = _DECODERS.get(schema)
        try:
            if decode is not None:
                return Published(decode(payload, encoding), payload, mime)
        except InputError:
            pass
        self.refused += 1
        return None


def _calibration(payload: bytes, encoding: str) -> CalibrationInfo:
    return decode_message(payload, encoding, CalibrationInfo, CALIBRATION)


_DECODERS: dict[str, Callable[[bytes, str], SkeletonFrame | RestSkeleton | CalibrationInfo]] = {
    wire.SCHEMA: wire.decode,
    REST_SKELETON: decode_rest_skeleton,
    CALIBRATION: _calibration,
}


def _only_instance(session: zenoh.Session, link: Link) -> str:
    """The name of the only matching daemon. Raises ConfigError for several."""
    with zenoh_call():
        replies = list(session.liveliness().get(keys.alive(link.instance_chunk), timeout=ASK_S))
    names = sorted({str(reply.ok.key_expr).split("/")[-2] for reply in replies if reply.ok})
    if len(names) > 1:
        raise ConfigError(
            f"several daemons are there: {', '.join(names)}", link.endpoint, "choose by --instance"
        )
    return names[0] if names else link.instance_chunk
