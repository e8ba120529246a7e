"""Checks the first pictures of cameras against their calibration and times, of recordings and live cameras alike.

Stores little: pictures of 320 px, 15 a second, during movement. With a single camera it can only check whether people
stand upright.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.calibrate.consistency.joint_scale import scaled_findings
from mocapd.calibrate.consistency.motion_delay import MotionMeter
from mocapd.calibrate.consistency.person_views import (
    PersonFinder,
    PersonView,
    RoomsByLight,
    WorkPictures,
    shrink,
)
from mocapd.calibrate.consistency.rig_judge import Stretch, judge
from mocapd.calibrate.consistency.room_judge import with_the_room
from mocapd.calibrate.consistency.time_judge import CameraTiming, judge_times
from mocapd.calibrate.consistency.world_judge import judge_world, turned_views
from mocapd.clock import seconds
from mocapd.types import Bytes, Camera, Floats, Frame, Rig

_EVERY_S = 1.0 / 15.0 - 0.005  # between stored pictures
_STRETCH_S = 2.0
_STRETCHES = 5
_PEOPLE = 2  # per stretch
_MOVES = 0.7  # of the logarithm of change, above the quietest tenth of the pictures
_ENOUGH_S = 12.0  # of motion
_MOST_PICTURES = 240  # pictures of a camera
_BY_TIME = (Mistake.CONTRADICTION, Mistake.ZOOMED)
# Least error of joints [m] that an uncorrected mistake causes, even where views agree about them
_OFF_M = {
    Mistake.DELAY: 0.1,
    Mistake.EXCHANGED: 0.3,
    Mistake.MIRRORED: 0.3,
    Mistake.TURNED: 0.3,
    Mistake.ZOOMED: 0.1,
    Mistake.INVERTED: 0.3,
    Mistake.AXES: 0.3,
    Mistake.UNIT: 0.3,
    Mistake.CONTRADICTION: 0.15,
}


@dataclass(frozen=True, slots=True)
class CheckResult:
    """findings: the contradictions; off_m: how far views contradict each other without remedy [m], 0 where they agree or
    all is corrected; looked: stretches of time with people in two cameras, or in the only one."""

    findings: tuple[CaptureFinding, ...] = ()
    off_m: float = 0.0
    looked: int = 0

    @property
    def late_s(self) -> dict[str, float]:
        """By camera, how much later its times are than given [s], for those that are certainly wrong."""
        return {
            finding.cameras[0]: finding.late_s for finding in self.findings if finding.is_mended
        }


@dataclass(slots=True, eq=False)
class _CameraBuffer:
    """Pictures of one camera. newest: its newest whole picture, where whole ones come."""

    camera: Camera
    meter: MotionMeter = field(default_factory=MotionMeter)
    times_s: list[float] = field(default_factory=list)
    pictures: list[Bytes] = field(default_factory=list)
    smaller: float = 1.0
    frames: int = 0
    first_s: float = 0.0
    last_s: float = 0.0
    newest: Bytes | None = None


class CaptureCheck:
    """Collects pictures and judges them; for one thread."""

    def __init__(
        self, rig: Rig, stature_m: float | None = None, breathe: Callable[[], object] = bool
    ) -> None:
        """breathe: called every few milliseconds of `result`, where others need the processor."""
        self._breathe = breathe
        self._buffers = {camera.name: _CameraBuffer(camera) for camera in rig.cameras}
        self._stature_m = stature_m

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self._buffers)

    def put(self, frame: Frame) -> None:
        """Add a picture of a camera of the rig; ignores one of another size than its calibration."""
        if self.put_whole(frame):
            self.put_small(frame.camera, frame.t_ns, *shrink(frame.pixels))

    def put_whole(self, frame: Frame) -> bool:
        """Add a whole picture of now, in addition to the smaller ones: the room's points come from the newest. Returns
        whether it was taken."""
        buffer = self._buffers.get(frame.camera)
        if buffer is None or frame.size_px != buffer.camera.size_px:
            return False
        buffer.newest = frame.pixels
        return True

    def put_small(self, camera: str, t_ns: int, small: Bytes, smaller: float) -> None:
        """The same for a picture that `shrink` already reduced."""
        buffer, t_s = self._buffers[camera], seconds(t_ns)
        buffer.meter.put(t_s, small)
        buffer.frames += 1
        buffer.first_s = t_s if buffer.frames == 1 else buffer.first_s
        buffer.last_s = t_s
        if buffer.times_s and t_s - buffer.times_s[-1] < _EVERY_S:
            return
        buffer.smaller = smaller
        buffer.times_s.append(t_s)
        buffer.pictures.append(small)
        if len(buffer.pictures) > _MOST_PICTURES:
            del buffer.times_s[0], buffer.pictures[0]

    @property
    def has_enough(self) -> bool:
        """Whether more pictures would add little."""
        there = [buffer for buffer in self._buffers.values() if buffer.frames > 1]
        if not there:
            return False
        return min(_moving_s(buffer.meter) for buffer in there) >= _ENOUGH_S

    def result(self) -> CheckResult:
        """The findings in the pictures so far: takes a second or two."""
        there = [buffer for buffer in self._buffers.values() if len(buffer.pictures) > 10]
        if not there:
            return CheckResult()
        cameras = [buffer.camera for buffer in there]
        times = judge_times([_timing(buffer) for buffer in there])
        late = times.findings
        late_s = {finding.cameras[0]: finding.late_s for finding in late if finding.is_mended}
        stretches = self._stretches(there, [late_s.get(camera.name, 0.0) for camera in cameras])
        names = tuple(camera.name for camera in cameras)
        first = [[view for part in stretches for view in part[i][:1]] for i in range(len(cameras))]
        turned = tuple(turned_views(cameras, first))
        if len(cameras) == 1:
            return CheckResult(
                turned,
                _OFF_M[Mistake.TURNED] if turned else 0.0,
                sum(1 for stretch in stretches if stretch[0]),
            )
        verdict = judge(cameras, stretches, times.moves_alike)
        pictures = [buffer.newest for buffer in there]
        findings = with_the_room(cameras, pictures, verdict.findings)
        if not findings and (scaled := tuple(scaled_findings(cameras, stretches))):
            findings = with_the_room(cameras, pictures, scaled)
        if not findings and not all(times.moves_alike):
            # cameras at their places with other times
            findings = tuple(
                finding for finding in verdict.findings if finding.mistake is Mistake.CONTRADICTION
            )
        if any(not finding.is_mended for finding in late):
            # views at different instants contradict each other for that reason alone
            findings = tuple(finding for finding in findings if finding.mistake not in _BY_TIME)
        if not findings and (of_world := judge_world(names, verdict.fits, self._stature_m)):
            findings = (of_world,)
        if turned and not any(
            finding.mistake in (Mistake.TURNED, Mistake.AXES, Mistake.INVERTED)
            for finding in findings
        ):
            findings = (*turned, *findings)
        off_m = max(
            (
                _OFF_M.get(finding.mistake, 0.0)
                for finding in (*late, *findings)
                if not finding.is_mended
            ),
            default=0.0,
        )
        return CheckResult(
            (*late, *findings), max(off_m, verdict.off_m if findings else 0.0), len(verdict.fits)
        )

    def _stretches(self, there: Sequence[_CameraBuffer], late_s: Sequence[float]) -> list[Stretch]:
        """The people in the stretches of time with most motion, at corrected times."""
        begin = max(buffer.times_s[0] + late for buffer, late in zip(there, late_s, strict=True))
        end = min(buffer.times_s[-1] + late for buffer, late in zip(there, late_s, strict=True))
        count = max(1, int((end - begin) / _STRETCH_S))
        edges = end - _STRETCH_S * np.arange(count, -1, -1)
        moved = [
            sum(
                _motion_between(buffer.meter, low - late, high - late)
                for buffer, late in zip(there, late_s, strict=True)
            )
            for low, high in pairwise(edges)
        ]
        chosen = sorted(np.argsort(moved)[::-1][:_STRETCHES])
        finder = PersonFinder(self._breathe)
        works = [
            WorkPictures(np.array(buffer.times_s), np.stack(buffer.pictures), buffer.smaller)
            for buffer in there
        ]
        rooms = [RoomsByLight(work) for work in works]
        turns: list[Sequence[int]] = [range(4)] * len(there)
        out: list[Stretch] = []
        for k in chosen:
            people = []
            for i, (work, late) in enumerate(zip(works, late_s, strict=True)):
                low, high = edges[k] - late, edges[k + 1] - late
                views = _people(finder, work, rooms[i], (low, high), turns[i])
                if views:
                    turns[i] = tuple({0, views[0].quarter_turns})
                people.append([replace(view, times_s=view.times_s + late) for view in views])
            out.append(people)
        return out


def _people(
    finder: PersonFinder,
    work: WorkPictures,
    rooms: RoomsByLight,
    between_s: tuple[float, float],
    turns: Sequence[int],
) -> list[PersonView]:
    ids = np.flatnonzero((work.times_s >= between_s[0]) & (work.times_s < between_s[1]))
    if len(ids) < 8:
        return []
    part = WorkPictures(work.times_s[ids], work.pictures[ids], work.smaller)
    return finder.people(part, rooms.during(part), _PEOPLE, turns)


def _moving_s(meter: MotionMeter) -> float:
    signal = meter.signal()
    if len(signal.times_s) < 2:
        return 0.0
    moves = signal.change > float(np.percentile(signal.change, 10)) + _MOVES
    return float(moves.mean() * (signal.times_s[-1] - signal.times_s[0]))


def _motion_between(meter: MotionMeter, low_s: float, high_s: float) -> float:
    signal = meter.signal()
    inside = (signal.times_s >= low_s) & (signal.times_s < high_s)
    change: Floats = signal.change[inside]
    return float(change.mean()) if len(change) else 0.0


def _timing(buffer: _CameraBuffer) -> CameraTiming:
    period_s = (buffer.last_s - buffer.first_s) / max(buffer.frames - 1, 1)
    return CameraTiming(buffer.camera.name, buffer.meter.signal(), max(period_s, 1e-3))
