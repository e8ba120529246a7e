"""Watches that each camera is the calibrated one and still at its calibrated place.

One memory of the room per camera (`landmark_memory.py`) serves three checks: identification of identical webcams before
their frames are used, detection of bumps, and detection of swapped cameras. `view_watch.py` compares the views of
people. Each trouble is logged once and becomes a notice of its cameras.
"""

import logging
import threading
from collections.abc import Callable, Iterable

from mocapd.calibrate.bump.bump_watch import BumpWatch, Mounting
from mocapd.calibrate.bump.landmark_memory import LandmarkMemory, is_other_room
from mocapd.calibrate.bump.swapped_cameras import SwappedCameras
from mocapd.calibrate.consistency.capture_check import CheckResult
from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.capture.base import Source
from mocapd.clock import NS_PER_S
from mocapd.pipeline.frame_hub import TakesFrames
from mocapd.pipeline.idle_moments import IdleMoments
from mocapd.service.identical_cameras import IdenticalCameras, Trust, identical_groups
from mocapd.service.room_memory import RoomMemory
from mocapd.service.thread_priority import watching
from mocapd.service.view_watch import ViewWatch
from mocapd.types import Bytes, Frame, Rig
from mocapd.user_command import user_command

_log = logging.getLogger(__name__)

_LOOK_EVERY_S = 1.0
_ROOM = "calibrate --step room"
_SAVE_NS = 600 * NS_PER_S  # interval of saving the rooms of identical webcams for the next start


class CameraWatch:
    """Filters frames between a hub and their consumers. Capture threads call `put` and `went`, the owner calls `start` and
    `stop`; the rest is thread-safe. A thread of low priority runs the checks. A new calibration needs a new instance."""

    def __init__(
        self,
        sources: Iterable[Source],
        rig: Rig | None,
        onwards: TakesFrames,
        rooms: RoomMemory | None = None,
        stature_m: float | None = None,
        idle: IdleMoments | None = None,
        on_death: Callable[[BaseException], None] | None = None,
    ) -> None:
        """rig: None disables all checks; onwards: receives the admitted frames; rooms: memory of earlier runs;
        idle: of the pipeline; on_death: receives an unexpected error of a thread."""
        sources = list(sources)
        calibrated = {camera.name: camera for camera in rig.cameras} if rig else {}
        self._cameras = {
            source.name: calibrated[source.name] for source in sources if source.name in calibrated
        }
        groups = identical_groups(sources, self._cameras)
        for group in groups:
            _log.info(
                "%s have the same vid:pid:serial, and only their USB ports distinguish them: keep each in its own",
                " and ".join(group),
            )
        earlier = rooms.read(self._cameras) if rooms is not None and groups else {}
        earlier = {name: earlier[name] for group in groups for name in group if earlier.get(name)}
        self._onwards, self._rooms, self._idle = onwards, rooms, idle
        self._on_death = on_death
        self._saved_ns: int | None = None
        self._memories = {
            name: LandmarkMemory(camera, earlier.get(name, ()))
            for name, camera in self._cameras.items()
        }
        self._bumps = {name: BumpWatch(memory) for name, memory in self._memories.items()}
        self._swapped = SwappedCameras(list(self._cameras.values()))
        self._views = ViewWatch(rig, self._newest_of, stature_m, idle=idle, on_death=on_death)
        self._compared = CheckResult()
        self._looked_at: dict[str, Frame] = {}
        self._misplaced: set[str] = set()
        self._warned: set[tuple[str, str | None]] = set()
        self._stopping = threading.Event()
        # Not a daemon thread: the interpreter's end within a call of OpenCV would abort the process.
        self._thread = threading.Thread(target=self._run, name="camera-watch")
        self._lock = threading.Lock()  # guards what follows
        self._newest: dict[str, Frame] = {}
        self._identical = IdenticalCameras(groups, earlier)

    def start(self) -> None:
        """Starts the threads; returns at once."""
        self._views.start()
        if self._cameras:
            self._thread.start()

    def stop(self) -> None:
        """Signals the threads to end; never blocks."""
        self._views.stop()
        self._stopping.set()

    def put(self, frame: Frame) -> None:
        """Takes a frame; drops it while the identity of its webcam is in doubt."""
        self._views.put(frame)
        with self._lock:
            self._newest[frame.camera] = frame
            is_admitted = self._identical.admit(frame.camera)
        if is_admitted:
            self._onwards.put(frame)

    def went(self, camera: str) -> None:
        """See `capture.camera_thread.thread.Presence`."""
        with self._lock:
            self._newest.pop(camera, None)
            self._identical.went(camera)

    def notice(self, camera: str) -> str:
        """The trouble with a camera and its fix, for users; empty without trouble."""
        with self._lock:
            notice = self._identical.notice(camera)
        if notice:
            return notice
        findings = _not_exchanged(self._compared)
        notices = [str(finding) for finding in findings if camera in finding.cameras]
        if self._swapped.is_swapped(camera):
            shown = self._swapped.partner(camera)
            notices.insert(
                0,
                f"shows what {'another camera' if shown is None else repr(shown)} should -- put each camera where it was "
                f"calibrated, or run `{user_command(_ROOM)}`",
            )
        return "; ".join(notices)

    def mounting(self, camera: str) -> Mounting:
        """The last result; `unknown` without calibration or while the camera's identity is in doubt."""
        if self._swapped.is_swapped(camera):
            return Mounting.SWAPPED
        with self._lock:
            trust = self._identical.trust(camera)
        if camera not in self._bumps or trust is not Trust.KNOWN:
            return Mounting.UNKNOWN
        return self._bumps[camera].mounting

    @property
    def off_m(self) -> float:
        """Lasting disagreement of the views of people [m]."""
        return self._views.off_m

    def _run(self) -> None:
        with watching(self._on_death):
            while not self._stopping.wait(_LOOK_EVERY_S):
                self.look()

    def look(self) -> None:
        """Runs the checks once. Takes some milliseconds per camera, in idle moments of the pipeline, and in the first minute
        a fifth of a second per pair of cameras."""
        self._take_comparison()
        newest: dict[str, Frame] = {}
        for name, camera in self._cameras.items():
            with self._lock:
                frame = self._newest.get(name)
                trust, losses = self._identical.trust(name), self._identical.losses(name)
            if frame is None or frame.size_px != camera.size_px:
                continue  # the tracker reports a wrong size
            newest[name] = frame
            if frame is self._looked_at.get(name) and trust is Trust.KNOWN:
                continue
            self._looked_at[name] = frame
            if trust is not Trust.KNOWN:
                self._identify(name, frame, losses)
            elif name not in self._misplaced:
                self._wait_for_idle()
                self._watch_mounting(name, frame)
        self._swapped.compare_points(newest)
        self._forget_misplaced()
        self._warn_of_swapped()
        self._save_rooms(max((frame.t_ns for frame in newest.values()), default=0))

    def _wait_for_idle(self) -> None:
        if self._idle is not None:
            self._idle.wait()

    def _newest_of(self, camera: str) -> Frame | None:
        with self._lock:
            return self._newest.get(camera)

    def _watch_mounting(self, name: str, frame: Frame) -> None:
        bump, memory = self._bumps[name], self._memories[name]
        before = bump.mounting
        now = bump.look(frame.t_ns, frame.pixels)
        if now is Mounting.BUMPED and before is not now:
            _log.warning(
                "camera %r was turned by about %.1f degrees, its calibration no longer holds --"
                " put it back, or run `%s`",
                *(name, bump.turn_deg, user_command(_ROOM)),
            )
        elif before is Mounting.BUMPED and now is Mounting.STEADY:
            _log.info("camera %r is back in its place", name)
        other = None
        if not bump.is_recognised and memory.views:
            likeliest, likeness = self._likeliest(frame.pixels, set(self._cameras) - {name})
            if is_other_room(memory.likeness(frame.pixels), likeness):
                other = likeliest
            else:
                bump.remember_unrecognised(frame.t_ns, frame.pixels)
        self._swapped.shows_room_of(name, other)

    def _forget_misplaced(self) -> None:
        """Clears the memory of cameras that contradict their calibration despite a positive identification: it holds the
        wrong room."""
        with self._lock:
            now = {
                name
                for name in self._cameras
                if self._swapped.misplaced_with(name) is not None
                and self._identical.trust(name) is Trust.KNOWN
            }
        for name in now ^ self._misplaced:
            if name in now:
                self._memories[name] = LandmarkMemory(self._cameras[name])
                self._bumps[name] = BumpWatch(self._memories[name])
                self._swapped.shows_room_of(name, None)
            with self._lock:
                self._identical.set_misplaced(name, name in now)
        if self._rooms is not None and now.intersection(self._identical.names) - self._misplaced:
            self._saved_ns = None
            self._rooms.write(self._cameras, {})
        self._misplaced = now

    def _identify(self, name: str, frame: Frame, losses: int) -> None:
        """Identifies a webcam in doubt, unless it was unplugged meanwhile."""
        memory, group = self._memories[name], self._identical.others(name)
        own = memory.likeness(frame.pixels) if memory.views else None
        other, likeness = self._likeliest(frame.pixels, group)
        with self._lock:
            if self._identical.losses(name) != losses:
                return
            before = self._identical.notice(name)
            trust = self._identical.judge(name, own, other, likeness)
            notice = self._identical.notice(name)
        is_other = trust is Trust.DOUBTED and is_other_room(own or 0.0, likeness)
        self._swapped.shows_room_of(name, other if is_other else None, is_sure=True)
        if notice and notice != before:
            _log.warning("%s: %s", name, notice)
        elif trust is Trust.KNOWN:
            self._swapped.examine_again(name)
            _log.info("%s: is itself, by the room that it sees", name)

    def _likeliest(self, pixels: Bytes, among: Iterable[str]) -> tuple[str, float]:
        """The camera whose room is most similar to a picture, and the similarity."""
        return max(
            ((name, self._memories[name].likeness(pixels)) for name in sorted(among)),
            key=lambda pair: pair[1],
            default=("", 0.0),
        )

    def _take_comparison(self) -> None:
        result, before = self._views.result, self._compared
        if result is before:
            return
        self._compared = result
        self._swapped.take_views(
            finding.cameras for finding in result.findings if finding.mistake is Mistake.EXCHANGED
        )
        logged = {(finding.mistake, finding.cameras) for finding in before.findings}
        for finding in _not_exchanged(result):
            if (finding.mistake, finding.cameras) not in logged:
                _log.warning("%s", finding)
        if before.findings and not result.findings and result.looked:
            _log.info("what the cameras show agrees with their calibration again")

    def _warn_of_swapped(self) -> None:
        """Logs each new pair once, and once the end; notices of identical webcams are logged elsewhere."""
        swapped = [name for name in self._cameras if self._swapped.is_swapped(name)]
        now = {_in_order(name, self._swapped.partner(name)) for name in swapped}
        for first, second in sorted(now - self._warned, key=str):
            if second is None:
                _log.warning("camera %r: %s", first, self.notice(first))
            elif not self._is_doubted(first) and not self._is_doubted(second):
                _log.warning(
                    "cameras %r and %r have changed places: each shows what the other's calibration is for --"
                    " exchange them, or run `%s`",
                    *(first, second, user_command(_ROOM)),
                )
        if self._warned and not now:
            _log.info("no cameras are swapped any more")
        self._warned = now

    def _is_doubted(self, camera: str) -> bool:
        with self._lock:
            return self._identical.trust(camera) is Trust.DOUBTED

    def _save_rooms(self, now_ns: int) -> None:
        """Saves the rooms of identical webcams for the next start: the first views at once, then every _SAVE_NS."""
        if self._rooms is None or not self._identical.names:
            return
        if self._saved_ns is not None and now_ns - self._saved_ns <= _SAVE_NS:
            return
        memories = {name: self._memories[name] for name in self._identical.names}
        views = {name: memory.views for name, memory in memories.items()}
        if all(views.values()) and any(memory.has_begun for memory in memories.values()):
            self._saved_ns = now_ns
            self._rooms.write(self._cameras, views)


def _in_order(name: str, other: str | None) -> tuple[str, str | None]:
    return (name, None) if other is None else (min(name, other), max(name, other))


def _not_exchanged(result: CheckResult) -> list[CaptureFinding]:
    return [finding for finding in result.findings if finding.mistake is not Mistake.EXCHANGED]
