"""Skeleton frames as VMC over UDP, to the program that draws the avatar."""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from mocapd.clock import monotonic_ns, seconds
from mocapd.errors import UnavailableError
from mocapd.outputs.base import SinkStatus
from mocapd.outputs.messages import CalibrationInfo, RestSkeleton, StateMessage
from mocapd.outputs.osc.osc_sink import Destination, parse_destination, status_of
from mocapd.outputs.rate_cap import RateCap
from mocapd.outputs.vmc.vmc_encoder import VmcEncoder
from mocapd.outputs.vmc.vmc_params import KEY, Params
from mocapd.outputs.vmc.vmc_space import vmc_heading
from mocapd.outputs.vmc.vrm_file import read_vrm
from mocapd.outputs.wire import SkeletonFrame

UNCALIBRATED, CALIBRATED = 0, 3
# T restarts after 18 hours: a float32 of more seconds has steps of 1/128 s and could not separate two frames
T_PERIOD_S = 65536.0
MOST_PERSONS = 16  # each has its own sockets and layouts
_MOST_PORT = 65535


@dataclass(slots=True)
class _Performer:
    """State of one person. destinations: those that could be opened."""

    encoder: VmcEncoder
    cap: RateCap
    destinations: tuple[Destination, ...] = field(default=())


class VmcSink:
    """A performer of VMC for each person, all of them with the same settings.

    Each destination has one socket from `open` to `close`: a receiver may take a new port for another sender.
    """

    name = "vmc"

    def __init__(self, params: Params, clock: Callable[[], int] = monotonic_ns) -> None:
        """Raises InputError for an unusable `.vrm` file."""
        self._params, self._clock = params, clock
        self._avatar = read_vrm(Path(params.vrm)) if params.vrm else None
        self._rests: dict[int, RestSkeleton] = {}
        self._calibration = UNCALIBRATED
        self._performers: dict[int, _Performer] = {}
        self._is_open = False
        self._opened_ns = 0

    def open(self) -> None:
        """Open the sockets of the first person. Raises UnavailableError for an address without a route."""
        self.close()
        self._opened_ns = self._clock()
        self._is_open = True
        performer = self._performers[0] = self._performer()
        performer.destinations = tuple(Destination(text, KEY) for text in self._params.destinations)

    def send(self, frame: SkeletonFrame) -> None:
        """Send one frame, at most `rate_hz` of them."""
        if not self._is_open or not 0 <= frame.person < MOST_PERSONS:
            return
        performer = self._performers.get(frame.person)
        if performer is None:
            performer = self._performers[frame.person] = self._joining(frame.person)
        now_ns = self._clock()
        if not performer.cap.takes(now_ns):
            return
        datagrams = performer.encoder.encode(
            frame,
            self._rests.get(frame.person),
            calibration=self._calibration,
            time_s=seconds(now_ns - self._opened_ns) % T_PERIOD_S,
        )
        for destination in performer.destinations:
            destination.send(datagrams)

    def send_state(self, message: StateMessage) -> None:
        """Store the person's skeleton, and whether the cameras are calibrated."""
        match message:
            case RestSkeleton(person=person):
                self._rests[person] = message
            case CalibrationInfo(cameras=cameras):
                self._calibration = CALIBRATED if cameras else UNCALIBRATED
            case _:
                pass

    def status(self) -> SinkStatus:
        """Frames over all persons' destinations."""
        performers = tuple(self._performers.values())
        return status_of([destination for p in performers for destination in p.destinations])

    def close(self) -> None:
        """Close the sockets; may be called twice."""
        self._is_open = False
        for performer in self._performers.values():
            for destination in performer.destinations:
                destination.close()
        self._performers = {}

    def _performer(self) -> _Performer:
        params = self._params
        where = vmc_heading(params.turn, params.yaw_deg, by_root=params.root == "root")
        encoder = VmcEncoder(where, params.mirror, params.bundle, self._avatar)
        return _Performer(encoder, RateCap(params.rate_hz))

    def _joining(self, person: int) -> _Performer:
        """A performer for a further person, on its own ports. Without a port or a route it sends nothing."""
        performer = self._performer()
        for text in self._params.destinations:
            address, port = parse_destination(text, KEY)
            port += person * self._params.port_step
            if port <= _MOST_PORT:
                shown = f"[{address}]:{port}" if ":" in address else f"{address}:{port}"
                with suppress(UnavailableError):
                    performer.destinations += (Destination(shown, KEY),)
        return performer
