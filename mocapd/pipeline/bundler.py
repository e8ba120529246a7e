"""Pairs the frames of free-running cameras by their time of capture. Pure: no thread, no clock.

Pairing. A set is built around an anchor: the frame of the first participating camera of the rig.
Another camera's frame belongs to the set if it is at most half a period from the anchor. With equal
rates this holds for exactly one frame of each camera, so the spread stays within half a period. Two
cameras half a period apart would change partners with every jitter; so a pairing has hysteresis: it
lasts until it exceeds half a period by `hysteresis_periods`.

Timeout. The bundler estimates each camera's period and delay (arrival minus capture), and so the
arrival of its next frame. A set is complete when its last expected frame arrives. Without that frame
it goes out at the expected arrival plus `slack_periods`, or after the camera's own wait. A camera that
missed `patience` sets in a row causes no wait until it returns.

Time. A set's time is that of its newest frame, for which the pose is estimated; each frame has its
own. Sets are ordered by their anchors. With different camera rates the newest frame of a set may be
older than the previous set's; such a set is timed just after the previous one.

Clocks. Frames have capture times; timeouts use arrival times, `now_ns`. Live callers give both; for
recordings in order of capture `now_ns` is omitted and defaults to the newest capture time.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field

from mocapd.clock import nanoseconds
from mocapd.errors import ConfigError
from mocapd.pipeline.camera_queue import CameraQueue
from mocapd.types import Frame, FrameSet


@dataclass(frozen=True, slots=True)
class BundlerParams:
    """Timeouts of a frame set; periods are estimated from the frames.

    period_s: assumed of a camera before its second frame [s]
    slack_periods: how late a frame may be before its set goes without it [periods]
    longest_wait_periods: no set waits longer than this after its first frame arrived [periods]; a camera
      with a delay beyond the others' by more is never paired, nor waited for
    hysteresis_periods: by how much an established pairing may exceed half a period [periods]
    patience: sets in a row that a camera may miss before sets stop waiting for it
    camera_waits_s: by camera, how long a set waits for it after its first frame arrived [s], in place of
      the slack and the longest wait
    """

    period_s: float = 1.0 / 30.0
    slack_periods: float = 0.5
    longest_wait_periods: float = 1.5
    hysteresis_periods: float = 0.15
    patience: int = 2
    camera_waits_s: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class CameraCounts:
    """One camera's frames. Always received = used + late + those queued in the bundler.

    late: discarded, because their set had gone or the time ran backwards within the camera;
    lost: never delivered (gaps in `seq`), not part of received.
    """

    received: int
    used: int
    late: int
    lost: int

    def __add__(self, other: "CameraCounts") -> "CameraCounts":
        return CameraCounts(
            self.received + other.received,
            self.used + other.used,
            self.late + other.late,
            self.lost + other.lost,
        )

    def since(self, before: "CameraCounts") -> "CameraCounts":
        """The frames after an earlier count."""
        return CameraCounts(
            self.received - before.received,
            self.used - before.used,
            self.late - before.late,
            self.lost - before.lost,
        )


class Bundler:
    """Turns frames into frame sets: times strictly increase, and no frame is used twice."""

    def __init__(self, camera_names: Iterable[str], params: BundlerParams | None = None) -> None:
        self._params = params or BundlerParams()
        period_ns = nanoseconds(self._params.period_s)
        # in rig order, which is the order of precedence among anchors
        self._cameras = {name: CameraQueue(name, period_ns) for name in camera_names}
        if not self._cameras:
            raise ConfigError("no camera is named", "bundler", "give at least one camera")
        self._waits_ns = {name: nanoseconds(s) for name, s in self._params.camera_waits_s.items()}
        self._now_ns: int | None = None
        self._deadline_ns: int | None = None
        self._last_set_ns: int | None = None
        self._last_ns = 0  # of the last set: its anchor's time, its members' names, its anchor
        self._last_names: frozenset[str] = frozenset()
        self._last_anchor: CameraQueue | None = None

    def add(self, frame: Frame, now_ns: int | None = None) -> tuple[FrameSet, ...]:
        """Add a frame; returns the sets that it completes, oldest first, mostly none or one.

        `now_ns`: its arrival on any monotonic clock; omit it for recordings. Raises KeyError for an
        unknown camera.
        """
        camera = self._cameras[frame.camera]
        now_ns = self._advance(frame.t_ns if now_ns is None else now_ns)
        camera.accept(frame, now_ns)
        return self._drain(now_ns)

    def flush(self, now_ns: int) -> tuple[FrameSet, ...]:
        """The sets whose timeout has passed at `now_ns`, oldest first."""
        return self._drain(self._advance(now_ns))

    def finish(self) -> tuple[FrameSet, ...]:
        """The sets still queued at the end of all streams, oldest first."""
        return self._drain(None)

    @property
    def deadline_ns(self) -> int | None:
        """When to call `flush` unless a frame comes first; None: nothing is waiting."""
        return self._deadline_ns

    def counts(self) -> dict[str, CameraCounts]:
        """Each camera's frame counts so far."""
        return {
            name: CameraCounts(camera.received, camera.used, camera.late, camera.lost)
            for name, camera in self._cameras.items()
        }

    def _advance(self, now_ns: int) -> int:
        self._now_ns = now_ns if self._now_ns is None else max(self._now_ns, now_ns)
        return self._now_ns

    def _drain(self, now_ns: int | None) -> tuple[FrameSet, ...]:
        sets = []
        while members := self._next_members(now_ns):
            sets.append(self._emit(members))
        return tuple(sets)

    def _next_members(self, now_ns: int | None) -> list[CameraQueue]:
        """The cameras of the next set, anchor first, each with its oldest frame; none while it waits.

        It is the set of the oldest queued frame. In rig order each camera's frame, queued or
        expected, claims the free ones within its reach, until the oldest is claimed.
        """
        self._deadline_ns = None
        self._discard_late()
        free = [camera for camera in self._cameras.values() if camera.frames]
        if not free:
            return []
        oldest = min(free, key=lambda camera: camera.head_ns)
        for camera in self._cameras.values():
            until_ns = None
            if camera in free:
                at_ns = camera.head_ns
            else:
                at_ns = camera.expected_ns(oldest.head_ns)
                until_ns = self._wait_until(camera, at_ns, oldest, now_ns)
                if until_ns is None:
                    continue
            claimed = [c for c in free if self._reaches(camera, at_ns, c, c.head_ns)]
            if oldest not in claimed:
                free = [c for c in free if c not in claimed]
            elif until_ns is not None:
                self._deadline_ns = until_ns
                return []
            else:
                self._deadline_ns = self._members_deadline(camera, oldest, now_ns)
                return claimed if self._deadline_ns is None else []
        raise AssertionError("the oldest frame claims itself")

    def _members_deadline(
        self, anchor: CameraQueue, oldest: CameraQueue, now_ns: int | None
    ) -> int | None:
        """Until when the set of this anchor waits for further members; None: it is complete."""
        waits = []
        for camera in self._cameras.values():
            at_ns = camera.expected_ns(anchor.head_ns)
            until_ns = self._wait_until(camera, at_ns, oldest, now_ns)
            if until_ns is not None and self._reaches(anchor, anchor.head_ns, camera, at_ns):
                waits.append(until_ns)
        return max(waits, default=None)

    def _wait_until(
        self, camera: CameraQueue, expected_ns: int, oldest: CameraQueue, now_ns: int | None
    ) -> int | None:
        """Until when to wait for a frame of this capture time; None: not, or no longer."""
        if now_ns is None or camera.frames or camera.missed >= self._params.patience:
            return None
        own_ns = self._waits_ns.get(camera.name)
        slack_ns = round(self._params.slack_periods * oldest.period_ns)
        longest_ns = round(self._params.longest_wait_periods * oldest.period_ns)
        until_ns = oldest.head_arrival_ns + (longest_ns if own_ns is None else own_ns)
        if camera.has_received and own_ns is None:
            arrival_ns = expected_ns + camera.delay_ns
            if arrival_ns > until_ns:
                return None  # it would come after the longest wait, each time
            until_ns = min(until_ns, arrival_ns + slack_ns)
        return until_ns if now_ns < until_ns else None

    def _reaches(self, anchor: CameraQueue, anchor_ns: int, other: CameraQueue, ns: int) -> bool:
        """Whether a frame of `other` taken at `ns` belongs to the anchor's taken at `anchor_ns`."""
        if other is anchor:
            return ns == anchor_ns
        offset_ns = ns - anchor_ns
        reach_periods = 0.5
        if anchor is self._last_anchor and offset_ns * other.offset_ns > 0:
            reach_periods += self._params.hysteresis_periods
        return abs(offset_ns) <= reach_periods * min(anchor.period_ns, other.period_ns)

    def _discard_late(self) -> None:
        """Drop the frames of sets that have gone out already."""
        anchor, last_ns = self._last_anchor, self._last_ns
        if anchor is None:
            return
        for camera in self._cameras.values():
            absent = camera.name not in self._last_names
            while camera.frames and (
                camera.head_ns <= last_ns
                or (absent and self._reaches(anchor, last_ns, camera, camera.head_ns))
            ):
                camera.discard()

    def _emit(self, members: list[CameraQueue]) -> FrameSet:
        anchor = members[0]
        t_ns = anchor.head_ns
        for camera in self._cameras.values():
            if camera in members:
                camera.offset_ns = camera.head_ns - t_ns
                continue
            expected_ns = camera.expected_ns(t_ns)
            if not camera.frames and self._reaches(anchor, t_ns, camera, expected_ns):
                camera.missed += 1
            camera.offset_ns = 0
        frames = {camera.name: camera.use() for camera in members}
        self._last_ns, self._last_names, self._last_anchor = t_ns, frozenset(frames), anchor
        set_ns = max(frame.t_ns for frame in frames.values())
        if self._last_set_ns is not None:
            set_ns = max(set_ns, self._last_set_ns + 1)
        self._last_set_ns = set_ns
        oldest_ns = min(frame.t_ns for frame in frames.values())
        return FrameSet(set_ns, frames, set_ns - oldest_ns)
