"""Groups frames of several cameras by time, and regroups them after a correction of the times."""

from collections import deque
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace

from mocapd.clock import NS_PER_S
from mocapd.types import Frame, FrameSet

_MOST_WAITING = 120  # frames that wait for another camera, which may have ended or be lost


def half_period_ns(fps_hz: float) -> int:
    """Largest time difference within a set: half a period of the fastest camera [ns]."""
    return round(0.5 * NS_PER_S / fps_hz)


def due_frames(ahead: Mapping[str, Frame], apart_ns: int) -> tuple[str, ...]:
    """The cameras whose next frame belongs to the earliest instant."""
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
    """Delays the frames of cameras by `late_s` [s] and regroups them. names: all cameras, in the rig's order."""
    apart_ns = half_period_ns(fps_hz)
    late_ns = {name: round(late_s.get(name, 0.0) * NS_PER_S) for name in names}
    waiting: dict[str, deque[Frame]] = {name: deque() for name in names}

    def next_set() -> FrameSet:
        due = due_frames({name: queue[0] for name, queue in waiting.items() if queue}, apart_ns)
        return as_set({name: waiting[name].popleft() for name in due})

    for frames in sets:
        for name, frame in frames.frames.items():
            waiting[name].append(replace(frame, t_ns=frame.t_ns + late_ns[name]))
        while all(waiting.values()) or max(map(len, waiting.values())) > _MOST_WAITING:
            yield next_set()
    while any(waiting.values()):
        yield next_set()
