"""State on Zenoh: published on change, and returned to later queries."""

import threading
from collections.abc import Callable
from contextlib import ExitStack

import msgspec
import zenoh

from mocapd.outputs import schemas, wire
from mocapd.outputs.messages import (
    CalibrationInfo,
    CameraStatus,
    Facing,
    Health,
    RestSkeleton,
    StateMessage,
)
from mocapd.outputs.zenoh import keys


class ZenohState:
    """Holds the newest message of each key. `set` from any thread; queries come on Zenoh's."""

    def __init__(self, instance: str, message_format: str) -> None:
        self._instance = instance
        self._mime = wire.JSON_MIME if message_format == "json" else wire.MSGPACK_MIME
        self._encode: Callable[[StateMessage], bytes] = (
            msgspec.json.encode if message_format == "json" else msgspec.msgpack.encode
        )
        self._lock = threading.Lock()  # guards _replies
        self._replies = {
            keys.schema(instance, name): (schemas.schema_json(name), schemas.ENCODING)
            for name in schemas.STRUCTS
        }
        self._session: zenoh.Session | None = None

    def attach(self, session: zenoh.Session, opened: ExitStack) -> None:
        """Answer queries on this session until `opened` closes, and publish changes there."""
        for family in (
            keys.health(self._instance),
            keys.camera_status(self._instance, keys.ANY),
            keys.calibration(self._instance),
            keys.rest_skeleton(self._instance, keys.ANY),
            keys.facing(self._instance, keys.ANY),
            keys.schema(self._instance, keys.ANY),
        ):
            # on Zenoh's own thread: the default Python thread would keep a process alive whose
            # main thread died
            handler = zenoh.handlers.Callback(self._answer_for(family), indirect=False)
            opened.enter_context(session.declare_queryable(family, handler))
        self._session = session

    def detach(self) -> None:
        """Stop publishing changes; the stored states stay."""
        self._session = None

    def set(self, message: StateMessage) -> None:
        """Make this the state of its key; may be called before `attach`."""
        key = self._key_of(message)
        payload, encoding = self._encode(message), f"{self._mime};{message.schema}"
        with self._lock:
            self._replies[key] = (payload, encoding)
        session = self._session
        if session is not None:
            session.put(key, payload, encoding=encoding)

    def _key_of(self, message: StateMessage) -> str:
        match message:
            case Health():
                return keys.health(self._instance)
            case CameraStatus(camera=camera):
                return keys.camera_status(self._instance, camera)
            case CalibrationInfo():
                return keys.calibration(self._instance)
            case RestSkeleton(person=person):
                return keys.rest_skeleton(self._instance, person)
            case Facing(person=person):
                return keys.facing(self._instance, person)

    def _answer_for(self, family: str) -> Callable[[zenoh.Query], None]:
        declared = zenoh.KeyExpr(family)

        def answer(query: zenoh.Query) -> None:
            with self._lock:
                replies = list(self._replies.items())
            with query:
                for key, (payload, encoding) in replies:
                    # always on the concrete key, whatever wildcards the query has
                    if declared.includes(key) and query.key_expr.intersects(key):
                        query.reply(key, payload, encoding=encoding)

        return answer
