"""Finds the board in a recording, and diagnoses pictures without it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import islice

from mocapd.calibrate.board.board_detection import (
    BoardDetector,
    BoardView,
    DetectionFailure,
    as_grey,
    settle_variant,
)
from mocapd.calibrate.board.board_recordings import Recording
from mocapd.calibrate.board.detection_diagnostics import (
    FIX,
    TELLING,
    diagnose_detection,
    downscale,
    most_telling,
)
from mocapd.calibrate.intrinsics.intrinsics import FEWEST_VIEWS
from mocapd.calibration.board_spec import BoardKind, BoardSpec
from mocapd.errors import ConfigError
from mocapd.types import Bytes

Progress = Callable[[str, int, int], None]
_PROBES = 6  # pictures per camera that decide the board's variant
_ASKED = 24  # pictures per camera without a board that may be diagnosed
_ASKED_PX = 1280  # their width at most
_ASKED_BYTES = 128 << 20  # of them in memory at most
_SURE = 2  # pictures with one reason that names another object end the diagnosis


@dataclass(frozen=True, slots=True, eq=False)
class BoardSighting:
    """The board in one camera's recording: views by index, and failures of pictures without.

    `spec` is the board in the recording: the given one, or a variant of it (inverted, the other layout).
    """

    recording: Recording
    spec: BoardSpec
    views: Mapping[int, BoardView]
    pictures: int
    failures: tuple[DetectionFailure, ...]

    @property
    def variant_note(self) -> str:
        """The difference between the board in the recording and the given one."""
        ink = "inverted" if self.spec.inverted else "dark on light"
        layout = "legacy" if self.spec.legacy else "present"
        return f"{self.recording.name}: the board is {ink}, of the {layout} layout, unlike given"


class SpreadSample:
    """Grey pictures evenly spread over a stream of unknown length; bounded in size."""

    def __init__(self) -> None:
        self._sample: list[Bytes] = []
        self._came = 0
        self._every = 1

    def offer(self, pixels: Bytes) -> None:
        if self._came % self._every == 0:
            grey = downscale(as_grey(pixels), _ASKED_PX)
            if len(self._sample) >= max(2, min(_ASKED, _ASKED_BYTES // grey.nbytes)):
                self._sample = self._sample[::2]
                self._every *= 2
            if self._came % self._every == 0:
                self._sample.append(grey)
        self._came += 1

    def spread(self) -> Iterator[Bytes]:
        """Grey pictures in bisection order: the first few of them lie far apart."""
        count = len(self._sample)
        bits = max(1, (count - 1).bit_length())
        for i in range(1 << bits):
            place = int(f"{i:0{bits}b}"[::-1], 2)
            if place < count:
                yield self._sample[place]


def sight_board(
    recording: Recording, spec: BoardSpec, stride: int, progress: Progress
) -> BoardSighting:
    """Looks for the board in every `stride`-th picture of a recording. Raises InputError (damaged)."""
    step = max(1, recording.frames // (stride * _PROBES)) * stride
    # no more of them in memory: some videos do not say how many there are
    probes = [pixels for _, pixels in islice(recording.pictures(step), _PROBES)]
    spec = settle_variant(spec, probes)
    sighting, blank = _search(recording, spec, stride, progress)
    if len(sighting.views) >= FEWEST_VIEWS:
        return sighting
    # the pictures above may all be without the board
    variant = settle_variant(spec, list(blank.spread())[:_PROBES])
    if variant != spec:
        sighting, blank = _search(recording, variant, stride, progress)
    if len(sighting.views) >= FEWEST_VIEWS:
        return sighting
    return replace(sighting, failures=_reasons(BoardDetector(sighting.spec), blank))


def _search(
    recording: Recording, spec: BoardSpec, stride: int, progress: Progress
) -> tuple[BoardSighting, SpreadSample]:
    """The sighting without diagnoses, and pictures without a board."""
    detector = BoardDetector(spec)
    views: dict[int, BoardView] = {}
    blank = SpreadSample()
    count = 0
    total = max(1, -(-recording.frames // stride))
    for index, pixels in recording.pictures(stride):
        view = detector.find(pixels, index)
        if view is not None:
            views[index] = view
        else:
            blank.offer(pixels)
        count += 1
        progress(f"board in {recording.name}", min(count, total), total)
    return BoardSighting(recording, spec, views, count, ()), blank


def _reasons(detector: BoardDetector, blank: SpreadSample) -> tuple[DetectionFailure, ...]:
    """Diagnoses picture by picture, until enough of them name the same object."""
    # the search for chessboards is slow
    most = _ASKED if detector.spec.kind is BoardKind.CHARUCO else _ASKED // 2
    failures: list[DetectionFailure] = []
    for grey in blank.spread():
        failures.append(diagnose_detection(detector, grey))
        reason = failures[-1].reason
        agreed = sum(failure.reason is reason for failure in failures)
        if len(failures) == most or (reason in TELLING and agreed == _SURE):
            break
    return tuple(failures)


def refuse_unseen(sightings: Sequence[BoardSighting]) -> None:
    """Raises ConfigError for the first camera with too few views of the board, with the most telling reason."""
    for sighting in sightings:
        if len(sighting.views) >= FEWEST_VIEWS:
            continue
        others = [
            other.recording.name for other in sightings if len(other.views) > len(sighting.views)
        ]
        where = str(sighting.recording.path)
        what = f"the board is usable in {len(sighting.views)} of {sighting.pictures} pictures"
        if others:
            what += f" (it is seen by {', '.join(others)})"
        if not sighting.failures:
            raise ConfigError(what, where, "show the board in more pictures")
        failure = most_telling(sighting.failures)
        what += f": {failure.reason}" + (f", {failure.detail}" if failure.detail else "")
        raise ConfigError(what, where, FIX[failure.reason])
