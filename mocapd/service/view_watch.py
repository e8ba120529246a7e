"""Periodically checks live views against calibration and clock offsets, by the checks of recordings.

While it collects, for about half a minute, each frame costs its capture thread the copy of a small picture. A thread of
low priority computes the rest, in idle moments of the pipeline. Then it pauses for minutes.
"""

import threading
from collections import deque
from collections.abc import Callable

import numpy as np

from mocapd.calibrate.consistency.capture_check import CaptureCheck, CheckResult
from mocapd.calibrate.consistency.person_views import WORK_PX
from mocapd.clock import seconds
from mocapd.pipeline.idle_moments import IdleMoments
from mocapd.service.thread_priority import watching
from mocapd.types import Bytes, Frame, Rig

_LONGEST_S = 120.0  # of collecting, when little moves
_REST_S, _REST_WARNED_S = 900.0, 120.0  # from one comparison to the next
_MOST_WAITING = 400  # small pictures: the thread is behind
_PAUSE_S = 0.25
_SPEED_M_S = 0.5  # of joints, as people move


class ViewWatch:
    """Capture threads call `put`, the owner calls `start` and `stop`; the rest is thread-safe."""

    def __init__(
        self,
        rig: Rig | None,
        newest: Callable[[str], Frame | None],
        stature_m: float | None = None,
        longest_s: float = _LONGEST_S,
        idle: IdleMoments | None = None,
        on_death: Callable[[BaseException], None] | None = None,
    ) -> None:
        """rig: None disables it. newest: thread-safe, the newest frame of a camera; longest_s: limit of collecting when
        little moves; idle: of the pipeline, which looks of the network wait for (None: for nothing); on_death: receives an
        unexpected error of the thread."""
        self._rig, self._stature_m, self._longest_s = rig, stature_m, longest_s
        self._newest, self._idle, self._on_death = newest, idle, on_death
        self._sizes = {camera.name: camera.size_px for camera in rig.cameras} if rig else {}
        self._waiting: deque[tuple[str, int, Bytes, float]] = deque(maxlen=_MOST_WAITING)
        self._is_collecting = bool(self._sizes)
        self._stopping = threading.Event()
        self._result = CheckResult()
        self._thread = threading.Thread(target=self._run, name="views")

    def start(self) -> None:
        """Starts collecting; returns at once."""
        if self._is_collecting:
            self._thread.start()

    def stop(self) -> None:
        """Signals the thread to end; never blocks."""
        self._stopping.set()
        self._is_collecting = False

    def put(self, frame: Frame) -> None:
        """Takes a frame; stores a small copy while collecting."""
        if not self._is_collecting or frame.size_px != self._sizes.get(frame.camera):
            return
        step = max(1, max(self._sizes[frame.camera]) // WORK_PX)
        picture, by = frame.small(step)
        every = step // by
        small = np.ascontiguousarray(picture[every // 2 :: every, every // 2 :: every])
        self._waiting.append((frame.camera, frame.t_ns, small, float(step)))

    @property
    def result(self) -> CheckResult:
        """The last comparison's result; a new object after each."""
        return self._result

    @property
    def off_m(self) -> float:
        """Lasting disagreement of the views in the last comparison [m]. Includes the motion of a person within a camera's
        delay, which is not corrected here."""
        late_s = max((abs(finding.late_s) for finding in self._result.findings), default=0.0)
        return max(self._result.off_m, _SPEED_M_S * late_s)

    def _run(self) -> None:
        with watching(self._on_death):
            while not self._stopping.is_set():
                result = self._compare()
                if result is None:
                    return
                self._result = result
                self._stopping.wait(_REST_WARNED_S if result.findings else _REST_S)
                self._waiting.clear()
                self._is_collecting = not self._stopping.is_set()

    def _breathe(self) -> None:
        if self._idle is not None and not self._stopping.is_set():
            self._idle.wait()

    def _compare(self) -> CheckResult | None:
        """Collects for half a minute and compares; None after `stop`."""
        assert self._rig is not None
        check = CaptureCheck(self._rig, self._stature_m, breathe=self._breathe)
        first_s: float | None = None
        while not self._stopping.wait(_PAUSE_S):
            t_s = 0.0
            while self._waiting:
                camera, t_ns, small, smaller = self._waiting.popleft()
                check.put_small(camera, t_ns, small, smaller)
                t_s = seconds(t_ns)
                first_s = t_s if first_s is None else first_s
            if first_s is not None and (check.has_enough or t_s - first_s > self._longest_s):
                self._is_collecting = False
                for frame in map(self._newest, self._sizes):
                    if frame is not None:
                        check.put_whole(frame)
                return check.result()
        return None
