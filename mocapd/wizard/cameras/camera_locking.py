"""Locks one camera's controls: lets the automatics settle, locks, and verifies that the picture stayed the same."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from operator import attrgetter

import numpy as np

from mocapd.calibrate.light.light_check import Flicker, find_flicker
from mocapd.calibrate.light.value_search import ValueSearch
from mocapd.capture.webcam.camera_controls import Control
from mocapd.capture.webcam.control_lock import UNITS_PER_S
from mocapd.capture.webcam.controls import Controls
from mocapd.clock import NS_PER_S
from mocapd.errors import Problem, UnavailableError
from mocapd.wizard.cameras.camera_locks import CameraLocks
from mocapd.wizard.cameras.picture_watch import PictureWatch, Recent

_SETTLE_NS = 2 * NS_PER_S
_SETTLE_LONGEST_NS = 8 * NS_PER_S
_HUNTING_NS = 6 * NS_PER_S // 10  # at first the automatics look for their values
_STEADY = 0.02  # relative change of brightness within half a second
# until a control takes effect: frames in transit, and the sensor's own delay
_EFFECT_NS = 45 * NS_PER_S // 100
_LOOK_NS = NS_PER_S // 4
_BRIGHTNESS_TOLERANCE = 0.25
_WARMTH_TOLERANCE = 0.15
_CLOSE = 0.05  # tolerance of a search
_JUDGE_NS = 13 * NS_PER_S // 10  # of unchanged frames, for detecting flicker
_FLICKER_EVERY_NS = 2 * NS_PER_S


class LockPhase(StrEnum):
    """`waiting`: for pictures."""

    WAITING = "waiting"
    SETTLING = "settling"
    LOCKING = "locking"
    LOCKED = "locked"


@dataclass(frozen=True, slots=True)
class _Aim:
    """A control and its target, so that the pictures look as before the lock."""

    control: Control
    reading: Callable[[Recent], float]
    wanted: float
    tolerance: float


def _alike(one: float, other: float, tolerance: float) -> bool:
    return 1 / (1 + tolerance) <= (one + 1e-3) / (other + 1e-3) <= 1 + tolerance


class CameraLocking:
    """A state machine, advanced by `tick`; `phase`, `share` (0..1), `controls`, `flicker` and `trouble` give its state.

    A source without controls (a simulated camera, a file, a network camera) only has to deliver for two seconds. Most
    cameras report the exposure of their automatic. The picture of others changes when the automatic goes off; then a
    search finds the value by the brightness.
    """

    def __init__(
        self, camera: str, fps_hz: float, given: Controls, locks: CameraLocks, watch: PictureWatch
    ) -> None:
        self.camera = camera
        self.phase = LockPhase.WAITING
        self.controls = given
        self.flicker: Flicker | None = None
        self.trouble: tuple[Problem, ...] = ()
        self._fps_hz, self._locks, self._watch = fps_hz, locks, watch
        self._mains_hz: int | None = None
        self._since_ns = 0  # start of the phase
        self._changed_ns = 0  # last change of a control
        self._wanted = (0.0, 0.0)  # brightness and warmth under the automatics
        self._share = 0.0
        self._aims: list[_Aim] = []
        self._search: ValueSearch | None = None
        self._judged_ns = 0

    @property
    def share(self) -> float:
        return {LockPhase.LOCKED: 1.0, LockPhase.LOCKING: 0.8}.get(self.phase, self._share)

    @property
    def exposure_s(self) -> float | None:
        """Exposure time [s], None where unknown."""
        units = self.controls.exposure
        return units / UNITS_PER_S if units and self.phase is LockPhase.LOCKED else None

    def again(self) -> None:
        self.phase, self.trouble, self.flicker, self._share = LockPhase.WAITING, (), None, 0.0
        self._mains_hz = None

    def tick(self, now_ns: int, live: bool) -> None:
        """Advance, if the camera delivers (`live`)."""
        if not live:
            # opening restores locked controls; an unfinished lock starts over
            if self.phase in (LockPhase.SETTLING, LockPhase.LOCKING):
                self.phase, self._share = LockPhase.WAITING, 0.0
            return
        try:
            self._go_on(now_ns)
        except UnavailableError as error:  # unplugged between status and question
            self.phase, self._share = LockPhase.WAITING, 0.0
            self.trouble = (Problem(error.what, self.camera, error.fix),)

    def _go_on(self, now_ns: int) -> None:
        if self.phase is LockPhase.WAITING:
            if self._locks.can_lock(self.camera):
                self._locks.set_free(self.camera)
            self.trouble = ()
            self.phase, self._since_ns = LockPhase.SETTLING, now_ns
        elif self.phase is LockPhase.SETTLING:
            self._settle(now_ns)
        elif self.phase is LockPhase.LOCKING:
            self._approach(now_ns)
        elif now_ns - self._judged_ns > _FLICKER_EVERY_NS:
            self._judged_ns = now_ns
            recent = self._watch.recent(self.camera).since(self._since_ns)
            self.flicker = find_flicker(recent.t_ns, recent.rows)

    def _settle(self, now_ns: int) -> None:
        settled_ns = now_ns - self._since_ns
        self._share = 0.8 * min(settled_ns / _SETTLE_NS, 1.0)
        recent = self._watch.recent(self.camera).since(self._since_ns)
        late = recent.since(now_ns - NS_PER_S // 2)
        if settled_ns < _SETTLE_NS or not len(late.t_ns):
            return
        by_frame = late.bgr.mean(axis=1)
        change = float(np.ptp(by_frame))
        steady = len(by_frame) >= 3 and change <= _STEADY * (float(by_frame.mean()) + 1.0)
        quiet = recent.since(self._since_ns + _HUNTING_NS)
        self.flicker = find_flicker(quiet.t_ns, quiet.rows)
        if not steady and self.flicker is None and settled_ns < _SETTLE_LONGEST_NS:
            return
        if not self._locks.can_lock(self.camera):
            self.phase, self._since_ns = LockPhase.LOCKED, now_ns
            return
        self._wanted = (late.brightness, late.warmth)
        self._lock(now_ns, Control.EXPOSURE, Control.GAIN)

    def _lock(self, now_ns: int, *by_brightness: Control) -> None:
        """Automatics off; then adjust these controls, as far as needed, to the brightness before."""
        if self.flicker is not None:
            self._mains_hz = self.flicker.mains_hz
            by_brightness = (Control.GAIN,)  # the exposure is of whole pulses, and must stay so
        self._locks.lock(self.camera, self._fps_hz, self._mains_hz)
        brightness, warmth = self._wanted
        self._aims = [
            _Aim(control, attrgetter("brightness"), brightness, _BRIGHTNESS_TOLERANCE)
            for control in by_brightness
        ]
        warm = attrgetter("warmth")
        self._aims.append(_Aim(Control.WB_TEMPERATURE, warm, warmth, _WARMTH_TOLERANCE))
        self._search = None
        self.phase, self._changed_ns = LockPhase.LOCKING, now_ns

    def _approach(self, now_ns: int) -> None:
        """Evaluate the last change, and make the next."""
        if now_ns - self._changed_ns < _EFFECT_NS + _LOOK_NS:
            return
        recent = self._watch.recent(self.camera)
        look = recent.since(self._changed_ns + _EFFECT_NS)
        if not len(look.t_ns):
            return
        if self._search is not None:
            self._search.report(self._aims[0].reading(look))
            self._try(now_ns)
            return
        while self._aims:
            aim = self._aims[0]
            is_met = _alike(aim.reading(look), aim.wanted, aim.tolerance)
            self._search = None if is_met else self._search_for(aim)
            if self._search is not None:
                self._search.report(aim.reading(look))
                self._try(now_ns)
                return
            self._aims.pop(0)
        if now_ns - self._changed_ns < _EFFECT_NS + _JUDGE_NS:
            return
        self.flicker = find_flicker(look.t_ns, look.rows)
        if self.flicker is not None and self._mains_hz is None:
            self._lock(now_ns)
            return
        self._keep(now_ns, look)

    def _try(self, now_ns: int) -> None:
        assert self._search is not None
        self._locks.write(self.camera, self._aims[0].control, self._search.value)
        self._changed_ns = now_ns
        if self._search.over:
            self._search = None
            self._aims.pop(0)

    def _search_for(self, aim: _Aim) -> ValueSearch | None:
        limits = self._locks.range(self.camera, aim.control)
        now = self._locks.read(self.camera, aim.control)
        if limits is None or now is None:
            return None
        high = limits.high
        if aim.control is Control.EXPOSURE:
            high = min(high, int(UNITS_PER_S / self._fps_hz))
        return ValueSearch(limits.low, high, now, aim.wanted, _CLOSE)

    def _keep(self, now_ns: int, look: Recent) -> None:
        brightness, warmth = self._wanted
        self.trouble = tuple(
            Problem(
                f"its {what} changed when it was locked",
                self.camera,
                "keep still and lock again; if it stays so, the camera does not take orders",
            )
            for what, before, now, tolerance in (
                ("brightness", brightness, look.brightness, _BRIGHTNESS_TOLERANCE),
                ("colour", warmth, look.warmth, _WARMTH_TOLERANCE),
            )
            if not _alike(now, before, tolerance)
        )
        self.controls = self._locks.keep(self.camera, self._mains_hz)
        self.phase, self._since_ns, self._judged_ns = LockPhase.LOCKED, now_ns, now_ns
