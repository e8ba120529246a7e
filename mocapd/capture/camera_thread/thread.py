"""One capture thread per camera: puts the newest frame into the mailbox and reopens a lost camera.

A thread that hangs in a driver cannot be ended. It is abandoned, and a new thread replaces it. If the abandoned thread
returns, its frame is dropped and it no longer touches the source.
"""

import logging
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

from mocapd.capture.base import CountsTorn, NodeManaged, Notices, Pluggable, Source
from mocapd.capture.camera_thread.capture_record import CaptureRecord
from mocapd.capture.camera_thread.capture_status import CaptureStatus
from mocapd.capture.camera_thread.frame_faults import FrameFaults
from mocapd.capture.camera_thread.reopening import BackOff, RestartBudget
from mocapd.clock import monotonic_ns, nanoseconds, seconds
from mocapd.errors import (
    CameraClosed,
    CameraLost,
    ConfigError,
    EndOfStream,
    InputError,
    MocapdError,
    PermissionDeniedError,
    UnavailableError,
)
from mocapd.types import Frame

_LOG = logging.getLogger(__name__)

STUCK_S = 8.0  # in one call of a driver; the longest successful call takes 3 [s]
MOST_STUCK = 3  # threads of one camera that may hang in its driver at a time
_LOOK_S = 0.25  # poll interval of a lost camera's USB port [s]


class Mailbox(Protocol):
    """Receives frames; `put` never blocks and may replace the previous frame."""

    def put(self, item: Frame, /) -> None: ...


class Presence(Protocol):
    """Receives every loss of a camera before its next frame, unless it was closed on request and opens again; called in
    the capture thread, must not block."""

    def went(self, camera: str, /) -> None: ...


class CaptureThread:
    """Reads one source until `stop` or the end of a recording.

    `on_death` is called in the capture thread with the unexpected exception that ended it, or with a ConfigError of
    the first `open`, which waiting cannot fix. A camera that appears or returns later with another size counts
    as lost; the other cameras continue. `expected_hz`: logs a warning once per opening when the measured rate is
    below 90 % of it. `size_px`: of its calibration.
    """

    def __init__(
        self,
        source: Source,
        mailbox: Mailbox,
        on_death: Callable[[BaseException], None],
        expected_hz: float | None = None,
        back_off: BackOff | None = None,
        *,
        budget: RestartBudget | None = None,
        size_px: tuple[int, int] | None = None,
        presence: Presence | None = None,
        stuck_s: float = STUCK_S,
    ) -> None:
        self._source = source
        self._counts_torn = (
            source if isinstance(source, CountsTorn) else None
        )  # checked once: it takes 0.1 ms
        self._notices = source if isinstance(source, Notices) else None
        self._plug = source if isinstance(source, Pluggable) else None
        self._node = source if isinstance(source, NodeManaged) else None
        self._mailbox = mailbox
        self._on_death = on_death
        self._expected_hz = expected_hz
        self._back_off = back_off if back_off is not None else BackOff()
        self._budget = budget if budget is not None else RestartBudget()
        self._faults = FrameFaults(size_px)
        self._presence = presence
        self._stuck_s = stuck_s
        self._stopping = threading.Event()
        self._woken = threading.Event()  # the pause before reopening is over
        self._record = CaptureRecord(source.name)
        self._generation = 0  # of the reading thread; earlier generations were abandoned
        self._called_ns: int | None = None  # start of the current call of the driver
        self._renewal = ""  # reason of a requested reopening
        self._is_untold = False  # a loss that `presence` was not told of
        self._plugging = ""  # see Pluggable
        self._stuck: list[threading.Thread] = []  # abandoned threads
        self._hang = CameraLost("")  # reported while one of them hangs
        self._thread = self._new_thread()

    # -- called by the owner ---------------------------------------------------------------------

    def start(self) -> None:
        """Starts the thread; returns at once."""
        self._thread.start()

    def let_go(self) -> None:
        """First phase of stopping: signals and wakes the thread; never blocks."""
        self._stopping.set()
        self._woken.set()
        self._source.close()

    def stop(self, timeout_s: float = 1.4) -> bool:
        """Signals and joins the thread. False when a driver still blocks it after `timeout_s` [s]."""
        self.let_go()
        if self._thread.ident is not None:
            self._thread.join(timeout_s)
        return not self._thread.is_alive()

    def look_again(self) -> None:
        """Ends the pause before reopening, as some camera was plugged in. Thread-safe."""
        self._woken.set()

    def renew(self, why: str) -> None:
        """Reopens the camera although it has not failed; thread-safe, never blocks."""
        self._renewal = why
        self._woken.set()
        self._source.close()

    def watch(self) -> None:
        """Replaces a thread that hangs in its driver; call it about once a second, from one thread.

        Recordings are exempt, as they may be slow. With MOST_STUCK hanging threads no new thread starts until one of
        them returns.
        """
        self._stuck = [thread for thread in self._stuck if thread.is_alive()]
        called_ns = self._called_ns
        stuck_ns = 0 if called_ns is None else monotonic_ns() - called_ns
        if stuck_ns >= nanoseconds(self._stuck_s) and not self._source.recorded:
            self._abandon(stuck_ns)
        never_ran = self._generation > 0 and self._thread.ident is None
        if never_ran and len(self._stuck) < MOST_STUCK and not self._stopping.is_set():
            self._thread.start()

    def _abandon(self, stuck_ns: int) -> None:
        self._generation += 1
        self._called_ns = None
        self._stuck.append(self._thread)
        self._thread = self._new_thread()
        self._hang = CameraLost(
            f"its driver has not come back for {seconds(stuck_ns):.0f} s, and is left to itself",
            fix="unplug the camera and plug it in again",
        )
        self._report_loss(self._hang)
        self._source.close()

    def status(self) -> CaptureStatus:
        """A snapshot; thread-safe, does not wait for a blocked read."""
        return self._record.status(self._torn())

    # -- in the thread ---------------------------------------------------------------------------

    def _new_thread(self) -> threading.Thread:
        # A daemon thread: a driver that never returns must not keep the process from ending.
        name = f"capture-{self._source.name}"
        return threading.Thread(target=self._run, args=(self._generation,), name=name, daemon=True)

    def _over(self, generation: int) -> bool:
        return self._stopping.is_set() or generation != self._generation

    def _run(self, generation: int) -> None:
        try:
            self._capture(generation)
        except MocapdError as error:  # its message suffices: no traceback
            self._die(error, generation)
        except BaseException as error:
            self._die(error, generation)
            raise
        finally:
            if generation == self._generation:
                self._source.close()

    def _die(self, error: BaseException, generation: int) -> None:
        if generation == self._generation:
            self._record.mark_ended(str(error) or type(error).__name__)
        self._on_death(error)

    def _capture(self, generation: int) -> None:
        failures, first = 0, generation == 0
        while not self._over(generation):
            frames_before = self._record.frames
            try:
                self._woken.clear()
                self._renewal = ""
                self._plugging = self._plugged_now()
                with self._driver_call(generation):
                    self._source.open()
                self._read_until_failure(generation)
            except EndOfStream as end:
                if self._over(generation):
                    break
                self._record.mark_ended(str(end))
                level = logging.WARNING if end.fix else logging.INFO  # a fix means it was truncated
                _LOG.log(level, "%s: %s", self._source.name, end)
                return
            except (
                CameraLost, UnavailableError, PermissionDeniedError, InputError, ConfigError
            ) as error:  # fmt: skip
                if self._over(generation):
                    break
                if isinstance(error, ConfigError) and first:
                    raise
                self._source.close()  # else the camera returns under another node number
                delivered = self._record.frames > frames_before
                failures = 1 if delivered else failures + 1
                self._wait_after(error, delivered, failures)
            first = False
        if generation == self._generation:
            self._record.mark_ended("stopped")

    def _read_until_failure(self, generation: int) -> None:
        first, judged = True, False
        self._faults.clear()
        while not self._over(generation):
            with self._driver_call(generation):
                frame = self._source.read()
            if generation != self._generation:
                return
            if first:
                self._record.mark_live(self._place())
                self._is_untold = False
            self._record.count_frame(frame)
            first = False
            self._mailbox.put(frame)
            if not self._source.recorded:
                self._check_pictures(frame)
            if not judged and self._record.rate.full:
                judged = True
                self._judge_rate()

    def _check_pictures(self, frame: Frame) -> None:
        """Raises CameraLost for a frozen camera."""
        of_source = self._notices.notice if self._notices is not None else ""
        if self._faults.add(frame, self._torn(), of_source):
            self._record.set_notice(self._faults.notice, self._place())
        if self._faults.frozen and self._node is None:
            raise CameraLost(
                "sends the same picture over and over",
                fix="it is opened again; where that does not help, unplug it and plug it in again",
            )

    def _judge_rate(self) -> None:
        measured_hz = self._record.rate.rate_hz()
        if self._expected_hz is None or measured_hz >= 0.9 * self._expected_hz:
            return
        if self._plug is not None:
            mend = "in dim light turn off automatic exposure, else its USB controller or the processor is overloaded"
        elif self._node is not None:
            mend = "its machine or the network is overloaded, or it is in dim light"
        else:
            mend = "the processor is overloaded"
        name, asked_hz = self._source.name, self._expected_hz
        _LOG.warning("%s: delivers %.1f Hz, asked for %g Hz: %s", name, measured_hz, asked_hz, mend)

    def _wait_after(self, error: MocapdError, delivered: bool, failures: int) -> None:
        renewal, self._renewal = self._renewal, ""
        if renewal:
            self._report_loss(CameraLost(renewal))
            self._woken.clear()
            return
        # unplugging is no failure: only failures of a camera that is present use the budget
        there = self._plug is None or bool(self._plugged_now())
        hangs = there and any(thread.is_alive() for thread in self._stuck)
        if hangs and isinstance(error, UnavailableError):
            error = (
                self._hang
            )  # our own thread holds the device: ending another program does not help
        ours = self._node is None or not self._node.camera_failed
        failed = delivered and not isinstance(error, CameraClosed)
        spent = failed and there and ours and self._budget.spend(monotonic_ns())
        if spent:
            error = self._budget.quarantine_error(error, self._plug is not None)
        self._report_loss(error)
        self._pause(self._budget.rest_s if spent else self._back_off.pause_s(failures))

    def _pause(self, pause_s: float) -> None:
        """Waits; ends early after a replug, `look_again` or `stop`."""
        until_ns = monotonic_ns() + nanoseconds(pause_s)
        while (left_s := seconds(until_ns - monotonic_ns())) > 0.0:
            if self._woken.wait(min(left_s, _LOOK_S)):
                self._woken.clear()
                return
            now = self._plugged_now()
            if now and now != self._plugging:
                self._budget.renew()
                return

    def _plugged_now(self) -> str:
        return self._plug.plugging() if self._plug is not None else ""

    def _place(self) -> str:
        return self._plug.place if self._plug is not None else ""

    @contextmanager
    def _driver_call(self, generation: int) -> Iterator[None]:
        """Marks a call of the driver for `watch`."""
        self._called_ns = monotonic_ns()
        try:
            yield
        finally:
            if generation == self._generation:
                self._called_ns = None

    def _torn(self) -> int:
        return self._counts_torn.torn if self._counts_torn is not None else 0

    def _report_loss(self, error: MocapdError) -> None:
        self._is_untold |= self._record.mark_lost(error)
        if isinstance(error, CameraClosed):
            return  # by us; it has gone only if it then does not open
        if self._is_untold and self._presence is not None:
            self._presence.went(self._source.name)
        self._is_untold = False
