"""Whether a camera was bumped: its pictures and the body have come apart, and stay apart.

A person who is half hidden, or tracked badly for a moment, also disagrees with the pictures; but then
to every side and not for long. A camera that was turned disagrees by the same shift all the time.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from mocapd.clock import nanoseconds, seconds
from mocapd.types import Floats


class Mounting(StrEnum):
    """`unknown`: not yet watched for long enough; `steady`; `bumped`: calibrate the room again."""

    UNKNOWN = "unknown"
    STEADY = "steady"
    BUMPED = "bumped"


@dataclass(frozen=True, slots=True)
class BumpParams:
    """When a shift counts."""

    window_s: float = 2.0  # over which a shift must persist
    learning_s: float = 3.0  # of good frames, from which the usual shift is learned
    least_shift_px: float = 1.5  # work px; the fit spreads a bump over the cameras
    spreads: float = 4.0  # and as many times the usual spread of a window's shift
    least_support_px: float = 200.0  # confirmed work px of a frame that counts
    least_share: float = 0.6  # of the usual support: less is a body that is hidden in part
    present: float = 0.6  # share of the window's frames that must count


@dataclass(frozen=True, slots=True, eq=False)
class Residual:
    """One camera in one frame: the mean way (2,) from what is drawn to what is seen [work px], and how
    many confirmed pixels it rests on."""

    shift_px: Floats
    support_px: float


@dataclass(slots=True, eq=False)
class _Watched:
    """What is remembered of one camera: stamped residuals, and what is usual."""

    recent: list[tuple[int, Residual]]
    learned: list[Floats]
    learned_s: float = 0.0
    last_ns: int | None = None
    usual: Floats | None = None
    spread_px: float = 0.0
    support_px: float = 0.0
    mounting: Mounting = Mounting.UNKNOWN


class BumpWatch:
    """Fed every frame's residuals by camera; tells the mounting of each. Pure: time comes with the frames.

    The body is fitted to all cameras at once, so of two cameras both may come apart from it when one
    is bumped; then both are named, the worse first, and the background tells which to look after.
    """

    def __init__(self, cameras: Sequence[str], params: BumpParams | None = None) -> None:
        self._p = params if params is not None else BumpParams()
        self._watched = {name: _Watched([], []) for name in cameras}

    def reset(self) -> None:
        """The room was calibrated anew: learn again what is usual."""
        for name in self._watched:
            self._watched[name] = _Watched([], [])

    def step(self, t_ns: int, residuals: Mapping[str, Residual]) -> Mapping[str, Mounting]:
        """The mounting of every camera; one without a body in this frame is absent from `residuals`."""
        for name, residual in residuals.items():
            self._see(self._watched[name], t_ns, residual)
        return {name: one.mounting for name, one in self._watched.items()}

    @property
    def bumped(self) -> tuple[str, ...]:
        """The cameras that came apart, the worst first."""
        away = {
            name: float(np.linalg.norm(self._window_shift(one) - one.usual))
            for name, one in self._watched.items()
            if one.mounting is Mounting.BUMPED and one.usual is not None and one.recent
        }
        return tuple(sorted(away, key=lambda name: -away[name]))

    def _see(self, one: _Watched, t_ns: int, residual: Residual) -> None:
        p = self._p
        dt_s = 0.0 if one.last_ns is None else min(seconds(t_ns - one.last_ns), 0.2)
        one.last_ns = t_ns
        enough = max(p.least_support_px, p.least_share * one.support_px)
        if residual.support_px >= enough and np.isfinite(residual.shift_px).all():
            one.recent.append((t_ns, residual))
        start_ns = t_ns - nanoseconds(p.window_s)
        one.recent = [(t, r) for t, r in one.recent if t > start_ns]
        if one.usual is None:
            self._learn(one, dt_s, t_ns)
            return
        expected = p.window_s / max(dt_s, 1e-3)
        if len(one.recent) < p.present * expected:
            return  # too little is seen to say anything new
        away = float(np.linalg.norm(self._window_shift(one) - one.usual))
        limit = max(p.least_shift_px, p.spreads * one.spread_px)
        if away > limit:
            one.mounting = Mounting.BUMPED
        elif away < 0.5 * limit:
            one.mounting = Mounting.STEADY

    def _learn(self, one: _Watched, dt_s: float, t_ns: int) -> None:
        """What is usual: middle and spread of the shift, from the first seconds that count."""
        if not one.recent or one.recent[-1][0] != t_ns:
            return
        one.learned.append(one.recent[-1][1].shift_px)
        one.support_px += (one.recent[-1][1].support_px - one.support_px) / len(one.learned)
        one.learned_s += dt_s
        if one.learned_s >= self._p.learning_s:
            all_of_them = np.stack(one.learned)
            one.usual = np.median(all_of_them, axis=0)
            # neighbouring frames err alike: about five independent ones are in a window
            one.spread_px = float(np.sqrt(all_of_them.var(axis=0).sum() / 5.0))
            one.mounting = Mounting.STEADY

    def _window_shift(self, one: _Watched) -> Floats:
        """Middle of the shift over the window: a moment's trouble does not move it."""
        shift: Floats = np.median(np.stack([r.shift_px for _, r in one.recent]), axis=0)
        return shift
