"""Frames of several cameras put together by their times, and put together anew once times are corrected."""

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from mocapd.clock import NS_PER_S
from mocapd.types import Frame, FrameSet

_MOST_WAITING = 120  # frames of one camera that wait for another one's: it has ended, or was away


def half_period_ns(fps_hz: float) -> int:
    """How far apart frames of one instant may be, by the fastest camera's rate."""
    return round(0.5 * NS_PER_S / fps_hz)


def due_frames(ahead: Mapping[str, Frame], apart_ns: int) -> tuple[str, ...]:
    """Of the next frame of each camera, those of the earliest instant."""
    until_ns = min(frame.t_ns for frame in ahead.values()) + apart_ns
    return tuple(name for name, frame in ahead.items() if frame.t_ns < until_ns)


def as_set(frames: Mapping[str, Frame]) -> FrameSet:
    """Frames in the rig's order as a set: its time is that of the first camera that is present."""
    t_ns = next(iter(frames.values())).t_ns
    spread_ns = max(abs(frame.t_ns - t_ns) for frame in frames.values())
    return FrameSet(t_ns, frames, spread_ns)


def delayed_sets(
    sets: Iterable[FrameSet], names: tuple[str, ...], late_s: Mapping[str, float], fps_hz: float
) -> Iterator[FrameSet]:
    """The same frames with the times of some cameras, by name, so much later, put together by those; names: all cameras,
    in the rig's order."""
    apart_ns = half_period_ns(fps_hz)
    late_ns = {name: round(late_s.get(name, 0.0) * NS_PER_S) for name in names}
    waiting: dict[str, deque[Frame]] = {name: deque() for name in names}

    def next_set() -> FrameSet:
        due = due_frames({name: ones[0] for name, ones in waiting.items() if ones}, apart_ns)
        return as_set({name: waiting[name].popleft() for name in due})

    for one in sets:
        for name, frame in one.frames.items():
            waiting[name].append(replace(frame, t_ns=frame.t_ns + late_ns[name]))
        while all(waiting.values()) or max(map(len, waiting.values())) > _MOST_WAITING:
            yield next_set()
    while any(waiting.values()):
        yield next_set()
