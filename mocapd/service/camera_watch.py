"""Watches whether each camera is the one that its calibration is of, and still where it was calibrated.

One memory of the room for each camera (`landmark_memory.py`) serves all: what identical webcams are known by before their
frames are used, what a bump is measured against, and which cameras are swapped. The views of people are compared
beside it (`view_watch.py`). What is wrong is logged once, and is a notice of the cameras concerned.
"""

import logging
import threading
from collections.abc import Iterable

from mocapd.calibrate.bump.bump_watch import BumpWatch, Mounting
from mocapd.calibrate.bump.landmark_memory import LandmarkMemory, is_other_room
from mocapd.calibrate.bump.swapped_cameras import SwappedCameras
from mocapd.calibrate.consistency.capture_check import CheckResult
from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.capture.base import Source
from mocapd.clock import NS_PER_S
from mocapd.pipeline.frame_hub import TakesFrames
from mocapd.service.identical_cameras import IdenticalCameras, Trust, identical_groups
from mocapd.service.room_memory import RoomMemory
from mocapd.service.view_watch import ViewWatch
from mocapd.types import Bytes, Frame, Rig

_log = logging.getLogger(__name__)

_KEPT_NS = 600 * NS_PER_S  # how often the rooms of identical webcams are kept for the next start


class CameraWatch:
    """Stands between a hub and what uses the frames. `put` and `went` are called by capture threads, `look` by one other
    thread, `start` and `stop` by the owner; anybody may ask for the rest. A room that was calibrated again gets another
    watch."""

    def __init__(
        self,
        sources: Iterable[Source],
        rig: Rig | None,
        onwards: TakesFrames,
        rooms: RoomMemory | None = None,
        stature_m: float | None = None,
    ) -> None:
        """rig: without one nothing is watched; onwards: takes the frames that may be used; rooms: of earlier runs."""
        sources = list(sources)
        calibrated = {camera.name: camera for camera in rig.cameras} if rig else {}
        self._cameras = {
            one.name: calibrated[one.name] for one in sources if one.name in calibrated
        }
        groups = identical_groups(sources, self._cameras)
        for group in groups:
            _log.info(
                "%s have the same vid:pid:serial, and are told apart by their USB ports: keep each in its own",
                " and ".join(group),
            )
        earlier = rooms.read(self._cameras) if rooms is not None and groups else {}
        earlier = {name: earlier[name] for group in groups for name in group if earlier.get(name)}
        self._onwards, self._rooms = onwards, rooms
        self._kept_ns: int | None = None
        self._memories = {
            name: LandmarkMemory(camera, earlier.get(name, ()))
            for name, camera in self._cameras.items()
        }
        self._bumps = {name: BumpWatch(memory) for name, memory in self._memories.items()}
        self._swapped = SwappedCameras(list(self._cameras.values()))
        self._views = ViewWatch(rig, self._newest_of, stature_m)
        self._compared = CheckResult()
        self._looked_at: dict[str, Frame] = {}
        self._misplaced: set[str] = set()
        self._warned: set[tuple[str, str | None]] = set()
        self._lock = threading.Lock()  # guards what follows
        self._newest: dict[str, Frame] = {}
        self._identical = IdenticalCameras(groups, earlier)

    def start(self) -> None:
        """Begin to compare views; returns at once."""
        self._views.start()

    def stop(self) -> None:
        """The comparison ends by itself soon; never blocks."""
        self._views.stop()

    def put(self, frame: Frame) -> None:
        """Hand in a frame; that of a webcam that may be another one goes no further."""
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
        """What people must do about a camera; empty when nothing."""
        with self._lock:
            notice = self._identical.notice(camera)
        if notice:
            return notice
        notices = [str(one) for one in _not_exchanged(self._compared) if camera in one.cameras]
        if self._swapped.is_swapped(camera):
            shown = self._swapped.partner(camera)
            notices.insert(
                0,
                f"shows what {'another camera' if shown is None else repr(shown)} should -- put each camera where it was "
                "calibrated, or run `mocapd calibrate --step room`",
            )
        return "; ".join(notices)

    def mounting(self, camera: str) -> Mounting:
        """As last seen; `unknown` for a camera without calibration, or that may be another one."""
        if self._swapped.is_swapped(camera):
            return Mounting.SWAPPED
        with self._lock:
            trust = self._identical.trust(camera)
        if camera not in self._bumps or trust is not Trust.KNOWN:
            return Mounting.UNKNOWN
        return self._bumps[camera].mounting

    @property
    def off_m(self) -> float:
        """By how much the views of people contradict each other for good [m]."""
        return self._views.off_m

    def look(self) -> None:
        """Call it about once a second: a picture of each camera takes some milliseconds, the points of two cameras a fifth of
        a second in the first minute."""
        self._take_comparison()
        newest: dict[str, Frame] = {}
        for name, camera in self._cameras.items():
            with self._lock:
                frame = self._newest.get(name)
                trust, losses = self._identical.trust(name), self._identical.losses(name)
            if frame is None or frame.pixels.shape[1::-1] != camera.size_px:
                continue  # of another size: the tracker says what is wrong
            newest[name] = frame
            if frame is self._looked_at.get(name) and trust is Trust.KNOWN:
                continue
            self._looked_at[name] = frame
            if trust is not Trust.KNOWN:
                self._identify(name, frame, losses)
            elif name not in self._misplaced:
                self._watch_mounting(name, frame)
        self._swapped.compare_points(newest)
        self._forget_misplaced()
        self._warn_of_swapped()
        self._keep_rooms(max((one.t_ns for one in newest.values()), default=0))

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
                " put it back, or run `mocapd calibrate --step room`",
                *(name, bump.turn_deg),
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
        """A camera that contradicts its calibration, though it was taken for itself, remembers the wrong room: it remembers
        nothing until it is back."""
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
                self._identical.misplaced(name, name in now)
        if self._rooms is not None and now.intersection(self._identical.names) - self._misplaced:
            self._kept_ns = None
            self._rooms.write(self._cameras, {})
        self._misplaced = now

    def _identify(self, name: str, frame: Frame, losses: int) -> None:
        """Judge a webcam that may be an identical one, if it was not unplugged meanwhile."""
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
        """The camera whose room a picture is most like, and how much."""
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
            one.cameras for one in result.findings if one.mistake is Mistake.EXCHANGED
        )
        known = {(one.mistake, one.cameras) for one in before.findings}
        for one in _not_exchanged(result):
            if (one.mistake, one.cameras) not in known:
                _log.warning("%s", one)
        if before.findings and not result.findings and result.looked:
            _log.info("what the cameras show agrees with their calibration again")

    def _warn_of_swapped(self) -> None:
        """Once of each two, and once when it is over; what `notice` says of identical webcams is logged already."""
        swapped = [name for name in self._cameras if self._swapped.is_swapped(name)]
        now = {_in_order(name, self._swapped.partner(name)) for name in swapped}
        for first, second in sorted(now - self._warned, key=str):
            if second is None:
                _log.warning("camera %r: %s", first, self.notice(first))
            elif not self._is_doubted(first) and not self._is_doubted(second):
                _log.warning(
                    "cameras %r and %r have changed places: each shows what the other's calibration is for --"
                    " exchange them, or run `mocapd calibrate --step room`",
                    *(first, second),
                )
        if self._warned and not now:
            _log.info("no cameras are swapped any more")
        self._warned = now

    def _is_doubted(self, camera: str) -> bool:
        with self._lock:
            return self._identical.trust(camera) is Trust.DOUBTED

    def _keep_rooms(self, now_ns: int) -> None:
        """Of identical webcams, for the next start: the first views at once, then now and then."""
        if self._rooms is None or not self._identical.names:
            return
        if self._kept_ns is not None and now_ns - self._kept_ns <= _KEPT_NS:
            return
        memories = {name: self._memories[name] for name in self._identical.names}
        views = {name: memory.views for name, memory in memories.items()}
        if all(views.values()) and any(memory.has_begun for memory in memories.values()):
            self._kept_ns = now_ns
            # a disk may be slow, and the thread that looks also gives signs of life
            threading.Thread(
                target=self._rooms.write, args=(self._cameras, views), name="rooms", daemon=True
            ).start()


def _in_order(name: str, other: str | None) -> tuple[str, str | None]:
    return (name, None) if other is None else (min(name, other), max(name, other))


def _not_exchanged(result: CheckResult) -> list[CaptureFinding]:
    return [one for one in result.findings if one.mistake is not Mistake.EXCHANGED]
