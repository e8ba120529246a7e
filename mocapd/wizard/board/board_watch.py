"""Searches the board in the cameras' newest pictures, a few of them with every tick."""

import threading
from collections import deque
from collections.abc import Iterable, Mapping

from mocapd.calibrate.board.board_detection import BoardDetector
from mocapd.calibrate.board.board_instant import BoardInstant, BoardObservation, motion_px
from mocapd.calibrate.board.board_sightings import Views
from mocapd.calibration.board_spec import BoardSpec
from mocapd.pipeline.frame_hub import FrameHub
from mocapd.types import Floats, Frame
from mocapd.wizard.step import Shape

# Indices of sightings are far apart, so that no two count as neighbouring frames of a recording, between which the board's
# motion is estimated; indices in between are for pictures without a sighting.
INDEX_STEP = 100
_KEPT = 4  # frames of a camera, for picking simultaneous ones
_STOPPED_NS = 700_000_000  # behind the newest of all: the camera has stopped
_AT_ONCE = 2  # pictures searched in one tick
_SHOWN_NS = 400_000_000  # how long corners stay drawn after the last detection


def index_after(earlier: Views) -> int:
    """Where the indices of new sightings begin: views of one index are simultaneous, so none of earlier ones."""
    indices = (index for own in earlier.values() for index in own)
    return INDEX_STEP * (max(indices, default=0) // INDEX_STEP + 1)


class RecentFrames:
    """The last few frames of every camera. Takes them in the capture threads; queried in the wizard's."""

    def __init__(self) -> None:
        self._lock = threading.Lock()  # guards the frames
        self._frames: dict[str, deque[Frame]] = {}

    def put(self, frame: Frame) -> None:
        with self._lock:
            self._frames.setdefault(frame.camera, deque(maxlen=_KEPT)).append(frame)

    def together(self) -> dict[str, Frame]:
        """By camera the frame nearest to the newest instant that all cameras have reached.

        Of cameras of equal rate they are at most half a period apart. One that has stopped is absent.
        """
        with self._lock:
            recent = {name: list(frames) for name, frames in self._frames.items()}
        if not recent:
            return {}
        newest_ns = max(frames[-1].t_ns for frames in recent.values())
        live = {
            name: frames
            for name, frames in recent.items()
            if newest_ns - frames[-1].t_ns <= _STOPPED_NS
        }
        instant_ns = min(frames[-1].t_ns for frames in live.values())
        return {
            name: min(frames, key=lambda frame: abs(frame.t_ns - instant_ns))
            for name, frames in live.items()
        }


class BoardWatch:
    """Searches the frames of one instant at a time, camera by camera. For one thread."""

    def __init__(
        self, hub: FrameHub, names: Iterable[str], spec: BoardSpec, first_index: int = 0
    ) -> None:
        self.names = tuple(names)
        self.newest: dict[str, BoardObservation] = {}  # each camera's last observation of the board
        self._hub, self._recent = hub, RecentFrames()
        self._detector = BoardDetector(spec)
        self._index = first_index
        self._frames: dict[str, Frame] = {}
        self._left: list[str] = []  # cameras of this instant not searched yet
        self._observations: dict[str, BoardObservation] = {}

    def start(self) -> None:
        self._hub.join(self._recent)

    def stop(self) -> None:
        self._hub.leave(self._recent)

    def change(self, spec: BoardSpec) -> None:
        """Search for this board from now on."""
        self._detector = BoardDetector(spec)
        self.newest = {}
        self._left = []

    def instant(self) -> BoardInstant | None:
        """Search a few pictures; returns the instant once all of its pictures have been searched."""
        if not self._left and not self._begin():
            return None
        for name in self._left[:_AT_ONCE]:
            self._search(self._frames[name])
        self._left = self._left[_AT_ONCE:]
        if self._left:
            return None
        t_ns = max(frame.t_ns for frame in self._frames.values())
        self.newest |= self._observations
        return BoardInstant(self._index, t_ns, self._frames, self._observations)

    def shapes(self, now_ns: int, still_px: Mapping[str, float]) -> dict[str, tuple[Shape, ...]]:
        """The newest corners: good where they move less than `still_px`, else a hint."""
        drawn: dict[str, tuple[Shape, ...]] = {}
        for name, last in self.newest.items():
            if now_ns - last.t_ns <= _SHOWN_NS:
                style = "good" if last.motion_px <= still_px[name] else "hint"
                drawn[name] = (Shape("points", points_of(last.view.corners_px), style),)
        return drawn

    def _begin(self) -> bool:
        frames = {
            name: frame for name, frame in self._recent.together().items() if name in self.names
        }
        before = {name: frame.t_ns for name, frame in self._frames.items()}
        if not frames or all(before.get(name) == frame.t_ns for name, frame in frames.items()):
            return False
        self._frames, self._left, self._observations = frames, list(frames), {}
        self._index += INDEX_STEP
        return True

    def _search(self, frame: Frame) -> None:
        view = self._detector.find(frame.pixels, self._index)
        if view is not None:
            moved_px = motion_px(self.newest.get(frame.camera), view, frame.t_ns)
            self._observations[frame.camera] = BoardObservation(view, frame.t_ns, moved_px)


def points_of(pixels: Floats) -> tuple[tuple[float, float], ...]:
    """(n,2) for a Shape."""
    return tuple((round(float(x), 1), round(float(y), 1)) for x, y in pixels)
