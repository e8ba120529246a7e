"""When the frames of a recording were exposed, also where the Unix clock was set meanwhile."""

from collections.abc import Sequence

from mocapd.outputs.wire import SkeletonFrame

_CLOCK_SET_NS = 1_000_000  # difference of both clocks' steps beyond which the Unix clock was set
# a step back of both clocks beyond which their machine was started anew; frames out of order are nearer
_STARTED_ANEW_NS = 1_000_000_000


def frame_times_ns(frames: Sequence[SkeletonFrame]) -> list[int]:
    """Of each frame [ns, Unix], from the first one's on, as if that clock had not been set; a frame out of order has the
    time of the one before it."""
    times_ns: list[int] = []
    last: SkeletonFrame | None = None
    for frame in frames:
        if last is None:
            last = frame
            times_ns.append(frame.capture_unix_ns)
            continue
        step_ns = _step_ns(last, frame)
        times_ns.append(times_ns[-1] + step_ns)
        if step_ns:
            last = frame
    return times_ns


def _step_ns(before: SkeletonFrame, after: SkeletonFrame) -> int:
    """Time from one frame to another [ns]; 0 if they are out of order.

    The monotonic clock cannot be set, but starts again with the daemon's machine; without a battery the Unix clock may
    then be behind.
    """
    unix_ns = after.capture_unix_ns - before.capture_unix_ns
    monotonic_ns = after.capture_monotonic_ns - before.capture_monotonic_ns
    if abs(unix_ns - monotonic_ns) <= _CLOCK_SET_NS:
        return max(0, unix_ns)
    if max(unix_ns, monotonic_ns) < -_STARTED_ANEW_NS:
        return _STARTED_ANEW_NS  # how long that took is not known
    return min((step_ns for step_ns in (unix_ns, monotonic_ns) if step_ns > 0), default=0)
