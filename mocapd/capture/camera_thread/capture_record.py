"""State, counters and log lines of one camera. Its capture thread writes, any thread reads."""

import logging
import threading

from mocapd.capture.camera_thread.capture_status import CaptureState, CaptureStatus
from mocapd.capture.camera_thread.rate import RateMeter
from mocapd.capture.camera_thread.reopening import RestartBudget
from mocapd.clock import monotonic_ns, seconds
from mocapd.errors import AmbiguousCameraError, ConfigError, MocapdError
from mocapd.types import Frame

_LOG = logging.getLogger(__name__)


class CaptureRecord:
    """The record of one camera from start to stop. Logs each change of state once.

    Rate limit: a loose plug, or a room as dark as the limit of black, must not fill the log for months. After ten losses
    or notices within ten minutes further ones are logged as debug until the rate falls.
    """

    def __init__(self, camera: str) -> None:
        self._camera = camera
        self._losses = RestartBudget(most=10, within_s=600.0)  # that are logged
        self._level = logging.WARNING
        self._notices = RestartBudget(most=10, within_s=600.0)  # that are logged
        self._notice_level = logging.WARNING
        self._lock = threading.Lock()  # guards what follows; held for moments only
        self._state = CaptureState.OPENING
        self._reason = ""
        self._notice = ""
        self._frames = 0
        self._openings = 0  # that delivered a frame
        self._last_frame_ns: int | None = None
        self._came_ns = 0  # arrival of the newest frame
        self._rate = RateMeter()

    def status(self, torn: int) -> CaptureStatus:
        """A snapshot; thread-safe. torn: the source's count of damaged frames."""
        with self._lock:
            live = self._state is CaptureState.LIVE
            silent_ns = monotonic_ns() - self._came_ns if live else 0
            return CaptureStatus(
                camera=self._camera,
                state=self._state,
                reason=self._reason,
                frames=self._frames,
                torn=torn,
                reopens=max(0, self._openings - 1),
                fps_hz=self._rate.rate_hz(silent_ns) if live else 0.0,
                last_frame_ns=self._last_frame_ns,
                silent_s=seconds(silent_ns),
                notice=self._notice if live else "",
            )

    @property
    def frames(self) -> int:
        """The number of frames so far."""
        return self._frames

    @property
    def rate(self) -> RateMeter:
        """Rate of the frames since the last opening; for the capture thread only."""
        return self._rate

    def mark_live(self, place: str) -> None:
        """Call at the first frame after an opening: a camera that opens but sends nothing is still lost."""
        with self._lock:
            self._openings += 1
            self._came_ns = monotonic_ns()  # else it counts as silent until `count_frame`
            self._rate.clear()
            before, self._state = self._state, CaptureState.LIVE
            self._reason, self._notice = "", place
        if before is CaptureState.LOST:
            level = logging.INFO if self._level == logging.WARNING else logging.DEBUG
            _LOG.log(level, "%s: is back%s", self._camera, f", {place}" if place else "")

    def count_frame(self, frame: Frame) -> None:
        """Counts a frame and updates the rate."""
        now_ns = monotonic_ns()
        with self._lock:
            self._frames += 1
            self._last_frame_ns, self._came_ns = frame.t_ns, now_ns
            self._rate.add(frame.t_ns)

    def set_notice(self, notice: str, place: str) -> None:
        """Sets and logs the trouble with the pictures; empty when it is over."""
        with self._lock:
            self._notice = notice or place
        if notice:
            is_many = self._notices.spend(monotonic_ns())
            self._notice_level = logging.DEBUG if is_many else logging.WARNING
            _LOG.log(self._notice_level, "%s: %s", self._camera, notice)
        else:
            level = logging.INFO if self._notice_level == logging.WARNING else logging.DEBUG
            _LOG.log(level, "%s: its pictures are as they should be again", self._camera)

    def mark_lost(self, error: MocapdError) -> bool:
        """Changes the state to lost; True if it was another state before.

        Logs each loss once: later attempts to open fail for reasons of their own. A camera that is back but has
        another size or an ambiguous identity is logged again.
        """
        was, reason = self._set(CaptureState.LOST, str(error))
        is_new = was is not CaptureState.LOST
        if is_new:
            self._count_loss()
        asks = isinstance(error, ConfigError | AmbiguousCameraError)
        news = is_new or (asks and str(error) != reason)
        what = "not there yet" if was is CaptureState.OPENING else "lost"
        _LOG.log(self._level if news else logging.DEBUG, "%s: %s: %s", self._camera, what, error)
        return is_new

    def mark_ended(self, reason: str) -> None:
        """Changes the state to ended: no more frames will come."""
        self._set(CaptureState.ENDED, reason)

    def _count_loss(self) -> None:
        before, is_many = self._level, self._losses.spend(monotonic_ns())
        self._level = logging.DEBUG if is_many else logging.WARNING
        if is_many and before == logging.WARNING:
            _LOG.warning(
                "%s: was lost %d times within %.0f minutes, and further losses are not logged until that is over --"
                " check its plug and its cable",
                *(self._camera, self._losses.most + 1, self._losses.within_s / 60.0),
            )

    def _set(self, state: CaptureState, reason: str) -> tuple[CaptureState, str]:
        """Sets state and reason; returns the previous ones."""
        with self._lock:
            before = self._state, self._reason
            self._state, self._reason = state, reason
            return before
