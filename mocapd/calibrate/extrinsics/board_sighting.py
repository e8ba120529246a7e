"""Where a recording shows the board, and why it is not seen where it is not."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from mocapd.calibrate.board.board_detection import (
    BoardDetector,
    BoardView,
    DetectionFailure,
    settle_variant,
)
from mocapd.calibrate.board.detection_diagnostics import FIX, diagnose_detection
from mocapd.calibrate.board.recordings import Recording
from mocapd.calibrate.intrinsics.intrinsics import IntrinsicsLimits
from mocapd.calibration.board_spec import BoardSpec
from mocapd.errors import ConfigError
from mocapd.types import Bytes

Progress = Callable[[str, int, int], None]
FEWEST_VIEWS = IntrinsicsLimits().fewest_views
_PROBES = 6  # pictures per camera that the board's variant is settled with
_ASKED = 2  # pictures per camera that are asked why there is no board


@dataclass(frozen=True, slots=True, eq=False)
class BoardSighting:
    """What was found in one camera's recording: views by index, and reasons of pictures without.

    `spec` is the board as found: the given one, or a variant of it (inverted, the other layout).
    """

    recording: Recording
    spec: BoardSpec
    views: Mapping[int, BoardView]
    pictures: int
    not_seen: tuple[DetectionFailure, ...]

    @property
    def variant_note(self) -> str:
        """How the board found differs from the given one."""
        ink = "inverted" if self.spec.inverted else "dark on light"
        layout = "legacy" if self.spec.legacy else "present"
        return f"{self.recording.name}: the board is {ink}, of the {layout} layout, unlike given"


def sight_board(
    recording: Recording, spec: BoardSpec, stride: int, progress: Progress
) -> BoardSighting:
    """Looks for the board in every `stride`-th picture of a recording. Raises InputError (damaged)."""
    step = max(1, recording.frames // (stride * _PROBES)) * stride
    probes = [pixels for _, pixels in recording.pictures(step)][:_PROBES]
    spec = settle_variant(spec, probes)
    detector = BoardDetector(spec)
    views: dict[int, BoardView] = {}
    blank: list[tuple[int, Bytes]] = []
    count = 0
    total = max(1, -(-recording.frames // stride))
    for index, pixels in recording.pictures(stride):
        view = detector.find(pixels, index)
        if view is not None:
            views[index] = view
        elif len(blank) < _ASKED:
            blank.append((index, pixels))
        count += 1
        progress(f"board in {recording.name}", min(count, total), total)
    reasons: tuple[DetectionFailure, ...] = ()
    if len(views) < FEWEST_VIEWS:
        reasons = tuple(diagnose_detection(detector, pixels, index) for index, pixels in blank)
    return BoardSighting(recording, spec, views, count, reasons)


def refuse_unseen(sightings: Sequence[BoardSighting]) -> None:
    """Raises ConfigError for the first camera that hardly sees the board, with the commonest reason."""
    for one in sightings:
        if len(one.views) >= FEWEST_VIEWS:
            continue
        others = [other.recording.name for other in sightings if len(other.views) > len(one.views)]
        where = str(one.recording.path)
        what = f"the board is usable in {len(one.views)} of {one.pictures} pictures"
        if others:
            what += f" (it is seen by {', '.join(others)})"
        if not one.not_seen:
            raise ConfigError(what, where, "show the board in more pictures")
        reason = Counter(told.reason for told in one.not_seen).most_common(1)[0][0]
        detail = next((told.detail for told in one.not_seen if told.reason is reason), "")
        what += f": {reason}" + (f", {detail}" if detail else "")
        raise ConfigError(what, where, FIX[reason])
