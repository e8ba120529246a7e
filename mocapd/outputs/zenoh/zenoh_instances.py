"""The daemons on a bus: liveliness, newest health and camera states of each."""

import threading
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field, replace

import zenoh

from mocapd.bus.zenoh_answers import limited_answers
from mocapd.bus.zenoh_calls import zenoh_call
from mocapd.bus.zenoh_limits import MAX_MESSAGE_BYTES
from mocapd.clock import monotonic_ns
from mocapd.errors import InputError
from mocapd.outputs.messages import CAMERA_STATUS, HEALTH, CameraStatus, Health
from mocapd.outputs.wire import decode_message
from mocapd.outputs.zenoh import keys

ASK_S = 1.0  # timeout of the query for earlier states [s]
MOST_INSTANCES = 1000
MOST_CAMERAS = 64  # of one daemon

_CHUNK = keys.ROOT.count("/") + 1  # index of the instance in a key


@dataclass(frozen=True, slots=True)
class InstanceState:
    """One daemon. alive: its liveliness token exists; health: its newest message, or None; cameras: by name; heard_ns:
    time of the newest message [ns, our CLOCK_MONOTONIC]; trouble: why that message is invalid, or empty."""

    name: str
    alive: bool = False
    health: Health | None = None
    cameras: Mapping[str, CameraStatus] = field(default_factory=dict)
    heard_ns: int = 0
    trouble: str = ""


def list_instances(session: zenoh.Session) -> tuple[InstanceState, ...]:
    """Every live daemon on this session's bus, by name, by one query."""
    instances = Instances()
    instances.ask(session, ASK_S)
    return tuple(state for state in instances.states() if state.alive)


class Instances:
    """The states of all daemons; `states` from any thread. Ended daemons stay, with alive = False."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._states: dict[str, InstanceState] = {}

    def follow(self, session: zenoh.Session, opened: ExitStack) -> None:
        """Subscribe until `opened` closes, and query the earlier states."""
        with zenoh_call():
            for key in (keys.health(keys.ANY), keys.camera_status(keys.ANY, keys.ANY)):
                # on Zenoh's own thread: the default Python thread hinders the interpreter's exit
                on_message = zenoh.handlers.Callback(self._on_message, indirect=False)
                opened.enter_context(session.declare_subscriber(key, on_message))
            on_token = zenoh.handlers.Callback(self._on_token, indirect=False)
            token = keys.alive(keys.ANY)
            opened.enter_context(session.liveliness().declare_subscriber(token, on_token))
        self.ask(session, ASK_S)

    def ask(self, session: zenoh.Session, timeout_s: float) -> None:
        """Query all of them once. Each query takes up to `timeout_s` [s] when a daemon does not answer."""
        with zenoh_call():
            alive = [
                reply.ok
                for reply in session.liveliness().get(keys.alive(keys.ANY), timeout=timeout_s)
                if reply.ok is not None
            ]
            for sample in alive:
                self._on_token(sample)
            for key in (keys.health(keys.ANY), keys.camera_status(keys.ANY, keys.ANY)):
                for sample in limited_answers(
                    session, key, timeout_s, MAX_MESSAGE_BYTES, target=zenoh.QueryTarget.ALL
                ):
                    self._on_message(sample)

    def states(self) -> tuple[InstanceState, ...]:
        """By name."""
        with self._lock:
            return tuple(self._states[name] for name in sorted(self._states))

    def _on_token(self, sample: zenoh.Sample) -> None:
        alive = sample.kind != zenoh.SampleKind.DELETE
        with self._lock:
            state = self._state(_instance(sample))
            if state is not None:
                self._states[state.name] = replace(state, alive=alive)

    def _on_message(self, sample: zenoh.Sample) -> None:
        if len(sample.payload) > MAX_MESSAGE_BYTES:
            return
        payload, encoding = sample.payload.to_bytes(), str(sample.encoding)
        is_health = str(sample.key_expr).endswith("/health")
        with self._lock:
            state = self._state(_instance(sample))
            if state is None:
                return
            heard = replace(state, heard_ns=monotonic_ns(), trouble="")
            try:
                if is_health:
                    health = decode_message(payload, encoding, Health, HEALTH)
                    self._states[state.name] = replace(heard, health=health)
                else:
                    status = decode_message(payload, encoding, CameraStatus, CAMERA_STATUS)
                    cameras = {**state.cameras, status.camera: status}
                    if len(cameras) <= MOST_CAMERAS:
                        self._states[state.name] = replace(heard, cameras=cameras)
            except InputError as error:
                self._states[state.name] = replace(heard, trouble=error.what)

    def _state(self, name: str) -> InstanceState | None:
        """Its state; None where there are too many daemons."""
        if name not in self._states and len(self._states) >= MOST_INSTANCES:
            return None
        return self._states.get(name) or InstanceState(name)


def _instance(sample: zenoh.Sample) -> str:
    return str(sample.key_expr).split("/")[_CHUNK]
