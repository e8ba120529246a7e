"""A camera of another machine as a Source: its pictures with the times of their exposure by our clock."""

import logging
import threading
from dataclasses import replace

from mocapd.capture.file import check_size
from mocapd.capture.remote import camera_wire
from mocapd.capture.remote.arrival_limit import ArrivalLimit
from mocapd.capture.remote.camera_wire import CameraState, Done, Order
from mocapd.capture.remote.clock_fit import ClockLine
from mocapd.capture.remote.picture_reader import PictureReader
from mocapd.capture.remote.remote_address import RemoteAddress
from mocapd.capture.remote.remote_controls import RemoteControls
from mocapd.capture.remote.remote_link import RemoteLink
from mocapd.capture.webcam.controls import Controls
from mocapd.capture.webcam.v4l2 import WebcamSettings
from mocapd.clock import NS_PER_S, monotonic_ns
from mocapd.errors import CameraLost, MalformedError, UnavailableError
from mocapd.types import Frame

_LOG = logging.getLogger(__name__)

_SILENT_NS = NS_PER_S  # without a picture: the node or the network is gone
_TORN_LIMIT_NS = 2 * NS_PER_S  # with damaged pictures only
_LOOK_S = 0.05  # longest wait for a picture between other checks
# initial clock estimate: at most so many requests and so long, until the error is below _GOOD_NS
_FIRST_PINGS, _FIRST_NS, _GOOD_NS = 40, 6 * NS_PER_S // 10, 200_000
_FIRST_ANSWER_S = 0.15  # then the next is asked
_ANSWER_S = 1.0  # from a node that is there
# Of the rate that is expected of it: a node that sends more costs no more.
_MOST_OF_RATE = 1.5
_TIME_SERVICE = "look at the time service of its machine, or restart the node"
_ORDER_S = 0.5  # an unauthorised order gets no answer


class RemoteSource:
    """See Source, and Lockable where the node permits this daemon to set the camera (`takes_orders`).

    Drops pictures beyond 1.5 times `settings.fps_hz` undecoded. `notice`: see Notices. `clock` converts exposure times
    to our clock. `torn` counts pictures that are damaged or have an impossible time. A restarted node is reconnected.
    `camera_failed`: see NodeManaged.
    """

    recorded = False

    def __init__(
        self,
        name: str,
        address: RemoteAddress,
        size_px: tuple[int, int] | None = None,
        settings: WebcamSettings | None = None,
        reduced_by: int = 1,
    ) -> None:
        """size_px: required (width, height), of its calibration. settings: only the controls are used, as the node sets
        size and rate; reduced_by: see SourceRequest."""
        self.name = name
        self.torn = 0
        self.camera_failed = False
        self._address, self._size_px = address, size_px
        self._settings = settings if settings is not None else WebcamSettings()
        self._lock = threading.Lock()  # guards what follows against `close` from another thread
        self._link: RemoteLink | None = None
        self._said_fast = False
        self._turn = 0  # of opening and closing
        self._state: CameraState | None = None
        self._takes_orders = False
        self._pictures = PictureReader(name, reduced_by)
        self._limit = ArrivalLimit(_MOST_OF_RATE * self._settings.fps_hz)

    @property
    def clock(self) -> ClockLine | None:
        """The node's clock against ours; None before an estimate."""
        link = self._link
        return link.clock.line if link is not None else None

    # -- Source ----------------------------------------------------------------------------------

    def open(self) -> None:
        """Raises UnavailableError with the node's own reason, or ConfigError for another size than its calibration."""
        self.close()
        self.camera_failed = False
        with self._lock:
            turn = self._turn
        link = RemoteLink(self._address)
        with self._lock:
            if turn == self._turn:
                self._link = link
        if self._link is not link:  # closed, or opened by another thread, while it connected
            link.close()
            raise UnavailableError("was closed while it was opened", self.name, "open it again")
        try:
            state = self._query_state(link)
            self._learn_clock(link)
            link.listen(self._limit)
        except BaseException:
            link.close()
            raise
        self._state = state
        self._set_up(link, state)

    def read(self) -> Frame:
        """Raises CameraLost when the camera left its node, the node or the network is gone, or only damage came."""
        link = self._link
        if link is None or self._state is None:
            raise CameraLost("not open", self.name, "call open first")
        began_ns = monotonic_ns()
        heard_ns = began_ns
        while True:
            now_ns = monotonic_ns()
            if link.is_closed:
                raise CameraLost("was closed", self.name, "it is opened again by itself")
            if link.is_gone or now_ns - heard_ns > _SILENT_NS:
                raise self._lost(link, *self._loss_reason(link))
            self._ping(link)
            self._look_at_rate()
            arrived = link.newest(_LOOK_S)
            if arrived is None:
                continue
            heard_ns = arrived.came_ns
            try:
                return self._pictures.read(arrived, self._state.size_px, link.run, link.clock.line)
            except MalformedError:
                self.torn += 1
            if monotonic_ns() - began_ns > _TORN_LIMIT_NS:
                raise self._lost(
                    link, "only damaged pictures arrive", "check the network and its node"
                )

    @property
    def notice(self) -> str:
        link = self._link
        trouble = link.clock.trouble(monotonic_ns()) if link is not None else ""
        return f"{trouble} -- {_TIME_SERVICE}" if trouble else ""

    def close(self) -> None:
        """Closes the connection and wakes a blocked `read`."""
        with self._lock:
            self._turn += 1
            link, self._link = self._link, None
        if link is not None:
            link.close()

    # -- Lockable --------------------------------------------------------------------------------

    @property
    def takes_orders(self) -> bool:
        """True if this daemon may set its controls: it is a webcam, and its node is paired with this daemon."""
        return self._takes_orders

    @property
    def settings(self) -> WebcamSettings:
        return self._settings

    def device(self) -> RemoteControls | None:
        link = self._link
        if link is None or link.is_closed or not self._takes_orders:
            return None
        return self._controls(link)

    def change(self, settings: WebcamSettings) -> None:
        """See Lockable; size and rate stay the node's own."""
        own = self._settings
        self._settings = replace(settings, size_px=own.size_px, fps_hz=own.fps_hz)
        device = self.device()
        if device is not None:
            self._keep(device, settings.controls)

    # -- opening ---------------------------------------------------------------------------------

    def _query_state(self, link: RemoteLink) -> CameraState:
        node, camera = self._address.node, self._address.camera
        states = link.ask_all(camera_wire.state(node, camera), CameraState, None, _ANSWER_S)
        if not states:
            raise UnavailableError(
                f"no camera {camera!r} of a node {node!r} answers there",
                self._address.endpoint,
                "start `mocapd camera-node`, which says what its cameras are called",
            )
        if len({state.run for state in states}) > 1:  # else their pictures and clocks would mix
            raise UnavailableError(
                f"{len(states)} camera nodes are called {node!r}, and each has a camera {camera!r}",
                self._address.endpoint,
                "start one of them with another --name",
            )
        state = states[0]
        if state.state != "live":
            what, fix = _trouble(state)
            raise UnavailableError(what, f"{self.name} at {node}", fix)
        check_size(self._address.place, self.name, state.size_px, self._size_px)
        return state

    def _learn_clock(self, link: RemoteLink) -> None:
        """Exchanges clock requests until the error is below _GOOD_NS or _FIRST_NS has passed."""
        began_ns = monotonic_ns()
        for _ in range(_FIRST_PINGS):
            answered = threading.Event()
            link.ping(answered)
            answered.wait(_FIRST_ANSWER_S)
            line = link.clock.line
            if line is not None and line.uncertainty_ns + line.asymmetry_ns < _GOOD_NS:
                return
            if link.is_closed or monotonic_ns() - began_ns > _FIRST_NS:
                break
        if link.clock.line is None:
            raise UnavailableError(
                "its node does not answer clock requests", self._address.place, "restart it"
            )

    def _set_up(self, link: RemoteLink, state: CameraState) -> None:
        """Sends the locked controls again, as a restarted node has lost them."""
        self._takes_orders = False
        if not state.can_set:
            return
        controls = self._controls(link)
        try:
            # also tests the permission: an unauthorised order gets no answer
            controls.keep(self._settings.controls)
        except UnavailableError as error:
            _LOG.info("%s: its node does not let it be set: %s", self.name, error.what)
            return
        self._takes_orders = True

    def _controls(self, link: RemoteLink) -> RemoteControls:
        key = camera_wire.control(self._address.node, self._address.camera)

        def ask(order: Order) -> Done:
            return link.ask(key, Done, order, _ORDER_S)

        return RemoteControls(self.name, ask)

    def _keep(self, device: RemoteControls, controls: Controls) -> None:
        try:
            device.keep(controls)
        except UnavailableError as error:  # repeated at its next opening
            _LOG.warning("%s: was not set: %s", self.name, error)

    # -- reading ---------------------------------------------------------------------------------

    def _ping(self, link: RemoteLink) -> None:
        try:
            link.ping_if_due()
        except UnavailableError as error:
            raise self._lost(link, error.what, error.fix) from None

    def _look_at_rate(self) -> None:
        if self._limit.is_exceeded and not self._said_fast:
            self._said_fast = True
            _LOG.warning(
                "%s: its node sends more than %g pictures a second, the others are dropped -- set fps_hz of its "
                "[[camera]] here to the rate at the node",
                *(self.name, self._limit.most_hz),
            )

    def _loss_reason(self, link: RemoteLink) -> tuple[str, str]:
        """The node's reason for a silent camera, and the fix."""
        key = camera_wire.state(self._address.node, self._address.camera)
        try:
            state = link.ask(key, CameraState, None, _ORDER_S)
        except UnavailableError:
            return "its node is gone", "check the network, and that `mocapd camera-node` runs there"
        # also for a camera that is back already
        self.camera_failed = link.is_gone or state.state != "live"
        if state.state == "live":
            return "its pictures do not arrive", "check the network: it may be too slow for them"
        return _trouble(state)

    def _lost(self, link: RemoteLink, what: str, fix: str) -> CameraLost:
        link.close()
        return CameraLost(what, f"{self.name} ({self._address.place})", fix)


def _trouble(state: CameraState) -> tuple[str, str]:
    """The trouble with a camera at its node, and the fix."""
    what, _, fix = state.reason.partition(" -- ")
    return what or f"is {state.state} at its node", fix or "it is tried again by itself"
