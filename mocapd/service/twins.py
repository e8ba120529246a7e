"""Webcams that only their sockets tell apart: after both were unplugged, what each sees must say which is which.

Two of one model without serial numbers, swapped, are found as if nothing had happened, each with the other's
calibration. So the room that each sees is remembered; when two of a kind were away together, their frames are
held back until each is known again by what it sees. Where that is not its own room, people are asked.
"""

import logging
import threading
from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum

from mocapd.calibrate.bump.landmarks import Landmarks, find_landmarks, measure_turn
from mocapd.capture.base import Pluggable, Source
from mocapd.clock import NS_PER_S
from mocapd.pipeline.frame_hub import TakesFrames
from mocapd.service.room_memory import RoomMemory
from mocapd.types import Bytes, Camera, Frame, Rig

_log = logging.getLogger(__name__)

_RENEWED_NS = 10 * NS_PER_S  # how often the room is remembered anew, in the present light
_KEPT_NS = 600 * NS_PER_S  # how often it is kept for the next start
_LEAST_MARKS = 20  # to remember a room by
# Of the marks that are seen again: in the same room 0.3 and more, also with a person in front; in the other camera's
# pictures of it 0.06 at most (measured on the simulated rooms).
_LEAST_AGREE, _LEAST_SHARE = 10, 0.2


class _Trust(StrEnum):
    KNOWN = "known"  # by what it sees, or because nothing speaks against it
    BELIEVED = "believed"  # since the start, though it does not see what it saw before that
    DOUBTED = "doubted"  # it takes no part


@dataclass(slots=True, eq=False)
class _Twin:
    """One of several alike. views: of its room, the first and the newest; losses: counts them."""

    camera: Camera
    group: frozenset[str]
    views: list[Landmarks] = field(default_factory=list)
    viewed_ns: int = 0
    newest: Frame | None = None
    away: bool = False
    losses: int = 0
    trust: _Trust = _Trust.KNOWN
    was_in: bool = True  # it was in its place since the start, as whoever started meant it
    seen: bool = False  # since the start
    notice: str = ""


class Twins:
    """Between a hub and whoever works with the frames. `put` and `went` are called by capture threads, `look` by one
    other."""

    def __init__(
        self,
        sources: Iterable[Source],
        rig: Rig | None,
        onwards: TakesFrames,
        memory: RoomMemory | None = None,
    ) -> None:
        """rig: without one there is no calibration to be swapped; memory: of earlier runs."""
        self._cameras = {camera.name: camera for camera in rig.cameras} if rig else {}
        groups = _alike(sources, self._cameras)
        self._onwards, self._memory = onwards, memory
        self._kept_ns: int | None = None
        self._lock = threading.Lock()  # guards what follows
        self._twins = {
            name: _Twin(self._cameras[name], group) for group in groups for name in sorted(group)
        }
        for group in groups:
            _log.info(
                "%s have the same vid:pid:serial, and are told apart by their USB ports: keep each in its own",
                " and ".join(sorted(group)),
            )
        if memory is not None and self._twins:
            for name, views in memory.read(self._cameras).items():
                if name in self._twins and views:
                    self._twins[name].views = views
                    self._twins[name].trust = _Trust.DOUBTED

    def put(self, frame: Frame) -> None:
        """Hand in a frame; of a camera that may be another one it goes no further."""
        twin = self._twins.get(frame.camera)
        if twin is not None:
            with self._lock:
                twin.newest, twin.away = frame, False
                if twin.trust is _Trust.DOUBTED:
                    return
                twin.seen = True
        self._onwards.put(frame)

    def went(self, camera: str) -> None:
        """See capture.thread.Presence."""
        twin = self._twins.get(camera)
        if twin is None:
            return
        with self._lock:
            twin.away, twin.newest = True, None
            twin.losses += 1
            group = [self._twins[name] for name in twin.group]
            away = [one for one in group if one.away]
            if len(away) > 1 and any(one.seen for one in group):
                for one in away:
                    one.trust, one.was_in = _Trust.DOUBTED, False

    def notice(self, camera: str) -> str:
        """What people must do about it; empty when nothing."""
        twin = self._twins.get(camera)
        return twin.notice if twin is not None else ""

    def look(self) -> None:
        """At what they see, about once a second; a picture of each takes some milliseconds."""
        for name, twin in self._twins.items():
            with self._lock:
                frame, trust, losses = twin.newest, twin.trust, twin.losses
            if frame is None or frame.pixels.shape[1::-1] != twin.camera.size_px:
                continue
            if trust is not _Trust.KNOWN:
                self._judge(name, frame, losses)
            elif not twin.views or frame.t_ns - twin.viewed_ns > _RENEWED_NS:
                _remember(twin, frame)
                self._keep(frame.t_ns)

    def _keep(self, now_ns: int) -> None:
        """For the next start: the first views at once, then now and then."""
        views = {name: one.views for name, one in self._twins.items() if one.views}
        is_due = self._kept_ns is None or now_ns - self._kept_ns > _KEPT_NS
        if self._memory is not None and is_due and len(views) == len(self._twins):
            self._kept_ns = now_ns
            # a disk may take its time, and whoever looks has signs of life to give
            words = self._cameras, views
            threading.Thread(
                target=self._memory.write, args=words, name="rooms", daemon=True
            ).start()

    def _judge(self, name: str, frame: Frame, losses: int) -> None:
        twin = self._twins[name]
        others = sorted(twin.group - {name})
        own = _likeness(twin, frame.pixels)
        other, likeness = max(
            ((one, _likeness(self._twins[one], frame.pixels)) for one in others),
            key=lambda pair: pair[1],
        )
        alike, of_others = " and ".join(sorted(twin.group)), " and ".join(others)
        if (own >= _LEAST_SHARE and own > 2 * likeness) or self._is_the_last(twin):
            self._trust(name, losses, _Trust.KNOWN, "")
        elif likeness >= _LEAST_SHARE and likeness > 2 * own:
            notice = (
                f"sees what {other} saw: {alike} are alike, and were swapped; it takes no part -- plug each into the "
                "port where it was"
            )
            self._trust(name, losses, _Trust.DOUBTED, notice)
        elif twin.was_in:
            notice = (
                f"does not see what it saw when mocapd ran last, and is like {of_others}: if they were swapped "
                "meanwhile, plug each into the port where it was; if it was moved, calibrate the room again"
            )
            self._trust(name, losses, _Trust.BELIEVED, notice)
        else:
            notice = (
                f"cannot be told from {of_others}: they are alike, were unplugged together, and what it sees now is "
                "known of neither; it takes no part -- plug each into the port where it was and start mocapd anew, "
                "which takes your word for it"
            )
            self._trust(name, losses, _Trust.DOUBTED, notice)

    def _trust(self, name: str, losses: int, trust: _Trust, notice: str) -> None:
        """What is found of it, if it was not unplugged meanwhile."""
        twin = self._twins[name]
        with self._lock:
            if twin.losses != losses:
                return
            before, told = twin.trust, twin.notice
            twin.trust, twin.notice = trust, notice
        if notice and notice != told:
            _log.warning("%s: %s", name, notice)
        elif trust is _Trust.KNOWN and before is not trust:
            _log.info("%s: is itself, by the room that it sees", name)

    def _is_the_last(self, twin: _Twin) -> bool:
        """Whether all the others are known again, and of this one nothing was: then there is no choice."""
        others = [one for one in (self._twins[name] for name in twin.group) if one is not twin]
        return not twin.views and all(one.trust is _Trust.KNOWN and not one.away for one in others)


def _alike(sources: Iterable[Source], known: Iterable[str]) -> list[frozenset[str]]:
    """The names of calibrated webcams that have vid, pid and serial in common, of each kind with several."""
    names = set(known)
    by_model: dict[tuple[str, str, str], set[str]] = {}
    for source in sources:
        if isinstance(source, Pluggable) and source.name in names:
            identity = source.identity
            if identity is not None:
                by_model.setdefault(identity.model, set()).add(source.name)
    return [frozenset(group) for group in by_model.values() if len(group) > 1]


def _remember(twin: _Twin, frame: Frame) -> None:
    twin.viewed_ns = frame.t_ns
    marks = find_landmarks(frame.pixels, twin.camera)
    if len(marks.places) >= _LEAST_MARKS:
        twin.views = [*twin.views[:1], marks]


def _likeness(twin: _Twin, pixels: Bytes) -> float:
    """The share of the marks of this one's room that are in a picture; 0 when they are too few."""
    best = 0.0
    for marks in twin.views:
        agree = measure_turn(marks, pixels, twin.camera).agree
        if agree >= _LEAST_AGREE:
            best = max(best, agree / len(marks.places))
    return best
