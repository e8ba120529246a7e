"""Every daemon on a bus: who lives, and what each last said of itself and its cameras."""

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

ASK_S = 1.0  # for what was said before [s]
MOST_INSTANCES = 1000
MOST_CAMERAS = 64  # of one daemon

_CHUNK = keys.ROOT.count("/") + 1  # of a key, in which the instance stands


@dataclass(frozen=True, slots=True)
class InstanceState:
    """One daemon. alive: its token is there; health: what it last said, None before; cameras: by name; heard_ns: when
    it last said something [ns, our CLOCK_MONOTONIC]; trouble: why it is not understood, empty when it is."""

    name: str
    alive: bool = False
    health: Health | None = None
    cameras: Mapping[str, CameraStatus] = field(default_factory=dict)
    heard_ns: int = 0
    trouble: str = ""


def list_instances(session: zenoh.Session, timeout_s: float = ASK_S) -> tuple[InstanceState, ...]:
    """Every daemon that lives on this session's bus, by name, as it answers now."""
    found = Instances()
    found.ask(session, timeout_s)
    return tuple(one for one in found.states() if one.alive)


class Instances:
    """What is known of them; `states` from any thread. Those that have ended are kept, as gone."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards what follows
        self._states: dict[str, InstanceState] = {}

    def follow(self, session: zenoh.Session, opened: ExitStack) -> None:
        """Learn of all that is said from now on, until `opened` is closed, and of what was said before."""
        with zenoh_call():
            for key in (keys.health(keys.ANY), keys.camera_status(keys.ANY, keys.ANY)):
                # on Zenoh's own thread: the Python thread it would else start hinders the interpreter's exit
                said = zenoh.handlers.Callback(self._said, indirect=False)
                opened.enter_context(session.declare_subscriber(key, said))
            lives = zenoh.handlers.Callback(self._lives, indirect=False)
            token = keys.alive(keys.ANY)
            opened.enter_context(session.liveliness().declare_subscriber(token, lives))
        self.ask(session, ASK_S)

    def ask(self, session: zenoh.Session, timeout_s: float) -> None:
        """Ask all of them, once. Each question may take so long [s] when one does not answer."""
        with zenoh_call():
            alive = [
                reply.ok
                for reply in session.liveliness().get(keys.alive(keys.ANY), timeout=timeout_s)
                if reply.ok is not None
            ]
            for sample in alive:
                self._lives(sample)
            for key in (keys.health(keys.ANY), keys.camera_status(keys.ANY, keys.ANY)):
                for sample in limited_answers(
                    session, key, timeout_s, MAX_MESSAGE_BYTES, target=zenoh.QueryTarget.ALL
                ):
                    self._said(sample)

    def states(self) -> tuple[InstanceState, ...]:
        """By name."""
        with self._lock:
            return tuple(self._states[name] for name in sorted(self._states))

    def _lives(self, sample: zenoh.Sample) -> None:
        alive = sample.kind != zenoh.SampleKind.DELETE
        with self._lock:
            state = self._state(_instance(sample))
            if state is not None:
                self._states[state.name] = replace(state, alive=alive)

    def _said(self, sample: zenoh.Sample) -> None:
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
                    one = decode_message(payload, encoding, CameraStatus, CAMERA_STATUS)
                    cameras = {**state.cameras, one.camera: one}
                    if len(cameras) <= MOST_CAMERAS:
                        self._states[state.name] = replace(heard, cameras=cameras)
            except InputError as error:
                self._states[state.name] = replace(heard, trouble=error.what)

    def _state(self, name: str) -> InstanceState | None:
        """What is known of it; None where there are too many."""
        if name not in self._states and len(self._states) >= MOST_INSTANCES:
            return None
        return self._states.get(name) or InstanceState(name)


def _instance(sample: zenoh.Sample) -> str:
    return str(sample.key_expr).split("/")[_CHUNK]
