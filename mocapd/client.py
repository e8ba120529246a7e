"""Client library for Python games: the newest body pose of a running mocapd.

    for body in mocapd.client.stream():
        if body.tracked:
            print(body["leftHand"].position_m)

Newest wins: a program slower than the daemon skips frames and never falls behind. Positions in
metres, right-handed, +Y up, the floor at y = 0, a person at rest faces +Z with the left hand
towards +X; rotations xyzw.
"""

import asyncio
import atexit
import math
import time
from collections.abc import AsyncIterator, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Self

import zenoh

from mocapd.bus.zenoh_answers import MOST_ANSWERS_BYTES, limited_answers
from mocapd.bus.zenoh_calls import hold_session, zenoh_call
from mocapd.errors import UnavailableError
from mocapd.outputs import wire
from mocapd.outputs.messages import Health, RestSkeleton, decode_health, decode_rest_skeleton
from mocapd.outputs.prediction.pose_predictor import PosePredictor
from mocapd.outputs.zenoh import keys
from mocapd.outputs.zenoh.daemon_link import ENDPOINT, Link, connect, connect_async

__all__ = ("ENDPOINT", "Body", "Client", "JointPose", "Link", "astream", "connect", "stream")

POLL_S = 0.002  # how often `Client.wait` looks [s]
_RING_FRAMES = 8  # queued frames, from which `predict` estimates the motion


@dataclass(frozen=True, slots=True)
class JointPose:
    """One bone: position in the world [m], rotation relative to the T-pose and to its parent bone.

    `confidence` 0..1 is near 0 for a joint that no camera sees. `uncertainty_m`: one standard deviation of the
    position, the root mean square over x, y and z [m]; inf where it is unknown, so that a weight of 1 / uncertainty_m**2
    is 0 there.
    """

    position_m: tuple[float, float, float]
    rotation_xyzw: tuple[float, float, float, float]
    local_rotation_xyzw: tuple[float, float, float, float]
    confidence: float
    uncertainty_m: float = math.inf


@dataclass(frozen=True, slots=True)
class Body:
    """A person at one instant: `body["leftHand"]` is a JointPose, by VRM 1.0 bone name.

    `frame` is the received message. While `tracked` is false there are no joints.
    """

    frame: wire.SkeletonFrame

    @property
    def tracked(self) -> bool:
        """True if the frame has a pose, measured or briefly predicted."""
        return bool(self.frame.joints)

    @property
    def tracking(self) -> str:
        """`live`, `coasting` or `lost`."""
        return self.frame.tracking

    @property
    def seq(self) -> int:
        """Number of the frame; a gap means frames that this program was too slow for."""
        return self.frame.seq

    @property
    def joints(self) -> Mapping[str, JointPose]:
        """All joints by name."""
        return {name: self[name] for name in self.frame.joints}

    @property
    def latency_s(self) -> float:
        """Time from the middle of the exposure to the daemon's publication [s]."""
        return (self.frame.publish_monotonic_ns - self.frame.capture_monotonic_ns) * 1e-9

    @property
    def age_s(self) -> float:
        """Time since the middle of the exposure [s]; across machines as accurate as their clocks."""
        return (time.time_ns() - self.frame.capture_unix_ns) * 1e-9

    def __getitem__(self, name: str) -> JointPose:
        """The joint of a bone. Raises KeyError for a bone without a pose, as all bones while not tracked."""
        joint = self.frame.joints[name]
        return JointPose(
            joint.p, joint.r, joint.l, joint.c, math.inf if joint.u is None else joint.u
        )

    def __contains__(self, name: object) -> bool:
        return name in self.frame.joints

    def __iter__(self) -> Iterator[str]:
        return iter(self.frame.joints)


class Client:
    """A connection that holds the newest body, for game loops that poll once per picture.

    It reconnects when the daemon restarts. `close` is thread-safe; the rest is for one thread at a time, and raises
    UnavailableError after it.
    """

    def __init__(self, link: Link | None = None) -> None:
        """Connect. Raises UnavailableError when no mocapd is found in time."""
        link = link or Link()
        self._opened, self._is_closed = ExitStack(), False
        self._session = self._opened.enter_context(connect(link))
        with zenoh_call():
            self._subscriber = self._opened.enter_context(
                self._session.declare_subscriber(link.key, zenoh.handlers.RingChannel(_RING_FRAMES))
            )
            self._healths = self._opened.enter_context(
                self._session.declare_subscriber(link.health_key, zenoh.handlers.RingChannel(1))
            )
            hold_session(self._session, self._subscriber, self._healths, owner=self)
        self._health: Health | None = None
        self._rest_key = link.rest_key
        self._predictor: PosePredictor | None = None  # created by the first `predict`
        self._newest_body: Body | None = None
        # a thread that waits in Zenoh would abort the process at exit
        atexit.register(self.close)

    def poll(self) -> Body | None:
        """The newest unread body; None without one. Never waits."""
        with self._call():
            samples = self._waiting()
        return self._newest(samples)

    def wait(self, timeout_s: float) -> Body | None:
        """The next body, waiting up to `timeout_s` [s]; None after the timeout."""
        deadline_s = time.monotonic() + timeout_s
        while (body := self.poll()) is None and time.monotonic() < deadline_s:
            time.sleep(POLL_S)
        return body

    def predict(self, to_time: float | None = None) -> Body | None:
        """Predicts the body at `to_time` [Unix time, s], now when None. Never waits.

        Call it once per picture with the time at which that will be visible. It compensates the delay of cameras, tracking
        and smoothing, and gives each picture of a 90 Hz display a pose of its own. It extrapolates the frames received so
        far by at most 0.1 s, then the pose stays. None before the first frame. Returns the newest body while `lost`, and
        for times before the newest frame.
        """
        if self._predictor is None:
            self._predictor = PosePredictor()
            if self._newest_body is not None:
                self._predictor.take(self._newest_body.frame)
        self.poll()
        unix_ns = time.time_ns() if to_time is None else round(to_time * 1e9)
        frame = self._predictor.at(unix_ns)
        return None if frame is None else Body(frame)

    def rest(self, timeout_s: float = 1.0) -> RestSkeleton | None:
        """Queries the person's current T-pose skeleton, which takes a millisecond; None without an answer or before the
        first tracked person. It changes with a new calibration, and slightly while the daemon learns the body. Raises
        InputError for an answer of another version.
        """
        with self._call():
            samples = limited_answers(self._session, self._rest_key, timeout_s, MOST_ANSWERS_BYTES)
        for sample in samples:
            return decode_rest_skeleton(sample.payload.to_bytes(), str(sample.encoding))
        return None

    def health(self) -> Health | None:
        """The daemon's last health message, sent about once a second; None before the first. `slowness` is one line
        while it is too slow for its cameras. Never waits. Raises InputError for a message of another version."""
        with self._call():
            samples = list(iter(self._healths.try_recv, None))
        if samples:
            newest = samples[-1]
            self._health = decode_health(newest.payload.to_bytes(), str(newest.encoding))
        return self._health

    def __iter__(self) -> Iterator[Body]:
        """Iterates over newest bodies; waits without limit, also while the daemon restarts."""
        with self._call():
            samples = iter(self._subscriber)
        while True:
            try:
                with self._call():
                    first = next(samples, None)
                    later = self._waiting() if first is not None else []
            except UnavailableError:  # closed between the two
                return
            if first is None:
                return
            body = self._newest([first, *later])
            assert body is not None
            yield body

    @contextmanager
    def _call(self) -> Iterator[None]:
        """Context of a call into Zenoh. Raises UnavailableError after `close`."""
        with zenoh_call():
            try:
                yield
            except zenoh.ZError:
                if not self._is_closed:
                    raise
                raise UnavailableError("this Client is closed", fix="make another one") from None

    def _waiting(self) -> list[zenoh.Sample]:
        """The queued samples, newest last."""
        return list(iter(self._subscriber.try_recv, None))

    def _newest(self, samples: list[zenoh.Sample]) -> Body | None:
        body = None
        for sample in samples if self._predictor is not None else samples[-1:]:
            body = self._newest_body = _body(sample)
            if self._predictor is not None:
                self._predictor.take(body.frame)
        return body

    def close(self) -> None:
        """Disconnects; idempotent. Ends an iteration in another thread."""
        atexit.unregister(self.close)
        self._is_closed = True
        with zenoh_call():
            self._opened.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def stream(
    endpoint: str = ENDPOINT,
    *,
    instance: str = keys.ANY,
    person: int = 0,
    connect_timeout_s: float | None = 2.0,
) -> Iterator[Body]:
    """Iterates over newest bodies; waits while the daemon restarts.

    Raises UnavailableError when no mocapd is found within `connect_timeout_s` [s] (None: waits),
    InputError when what arrives is no frame of this version. For TLS see `Client` and `Link`.
    """
    with Client(Link(endpoint, instance, person, connect_timeout_s)) as client:
        yield from client


async def astream(
    endpoint: str = ENDPOINT,
    *,
    instance: str = keys.ANY,
    person: int = 0,
    connect_timeout_s: float | None = 2.0,
) -> AsyncIterator[Body]:
    """As `stream`, for asyncio: `async for body in astream()`."""
    link = Link(endpoint, instance, person, connect_timeout_s)
    loop = asyncio.get_running_loop()
    newest: asyncio.Queue[zenoh.Sample] = asyncio.Queue(maxsize=1)

    def replace_newest(sample: zenoh.Sample) -> None:
        if newest.full():
            newest.get_nowait()
        newest.put_nowait(sample)

    def on_sample(sample: zenoh.Sample) -> None:  # on Zenoh's thread
        loop.call_soon_threadsafe(replace_newest, sample)

    # indirect=False: Zenoh would start a Python thread that blocks the interpreter's exit
    handler = zenoh.handlers.Callback(on_sample, indirect=False)
    with await connect_async(link) as session, session.declare_subscriber(link.key, handler):
        while True:
            yield _body(await newest.get())


def _body(sample: zenoh.Sample) -> Body:
    return Body(wire.decode(sample.payload.to_bytes(), str(sample.encoding)))
