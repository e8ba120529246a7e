"""Numbers a webcam's frames so that lost ones show: OpenCV hides the driver's sequence number, so the time stamps tell."""

from collections import deque

_REMEMBERED = 16  # intervals and delays
_FEWEST = 6  # intervals that make a period
_SHORTEST = 2  # index of the sorted intervals: the third is no outlier, and has no lost frame where two in three are lost
_LIKE_IT = 1.5  # longer than the shortest by so much: a frame is missing
_TOLERANCE = 0.25  # periods: a frame that is lost makes a whole number of periods, a longer exposure does not


class FrameNumbers:
    """Counts frames by the driver's time stamps.

    A frame that this program made room for too late is not counted as lost: the driver drops pictures while it has no
    free buffer, and then this machine is slow, not the camera. Of a camera that halves its rate up to 13 frames are
    counted as lost, until the new period is known. Used by one thread.
    """

    def __init__(self) -> None:
        self._next = 0
        self.restart()

    def restart(self) -> None:
        """The camera was opened: the time before is no gap, and the rate may be another one."""
        self._last: tuple[int, int] | None = None  # stamp, and when the buffer was given back [ns]
        self._intervals_ns: deque[int] = deque(maxlen=_REMEMBERED)
        self._delays_ns: deque[int] = deque(maxlen=_REMEMBERED)

    def number(self, stamp_ns: int | None, given_back_ns: int) -> int:
        """The number of the next frame. stamp_ns: the driver's, None for a driver without; given_back_ns: when the driver
        got the frame's buffer back, of the same clock."""
        if stamp_ns is None:
            self._last = None
        else:
            if self._last is not None:
                self._next += self._lost(stamp_ns, *self._last)
                self._intervals_ns.append(stamp_ns - self._last[0])
            self._delays_ns.append(given_back_ns - stamp_ns)
            self._last = stamp_ns, given_back_ns
        number, self._next = self._next, self._next + 1
        return number

    def _lost(self, stamp_ns: int, last_ns: int, last_given_back_ns: int) -> int:
        """Frames that the camera took between two that arrived, and that found a free buffer."""
        if len(self._intervals_ns) < _FEWEST:
            return 0
        ordered = sorted(self._intervals_ns)
        whole = [one for one in ordered if one < _LIKE_IT * ordered[_SHORTEST]]
        period_ns = whole[len(whole) // 2] if whole else 0
        if period_ns <= 0:
            return 0
        periods = (stamp_ns - last_ns) / period_ns
        missing = round(periods) - 1
        if missing < 1 or abs(periods - round(periods)) > _TOLERANCE:
            return 0
        late_ns = last_given_back_ns - last_ns - min(self._delays_ns)
        return max(0, missing - round(late_ns / period_ns))
