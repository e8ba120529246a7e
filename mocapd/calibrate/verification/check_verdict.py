"""Turns five seconds of tracking into a verdict on each camera and on the room."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from mocapd.calibrate.verification.check_measure import CameraMeasure, Measure
from mocapd.errors import Problem

GOOD_PX, BAD_PX = 2.5, 6.0  # of a picture 640 px wide
GOOD_CM, BAD_CM = 1.5, 3.5
GOOD_MATCH, BAD_MATCH = 0.6, 0.4
GOOD_DROPPED, BAD_DROPPED = 0.05, 0.2  # share of a camera's frames
GOOD_RATE = 0.9  # of the requested rate
_WIDTH_PX = 640
_LEAN_RAD = math.radians(20.0)
_FLOOR_M = 0.12
_SCALE = 0.08


class Grade(StrEnum):
    """How reliable a result is."""

    GOOD = "good"
    DOUBTFUL = "doubtful"
    BAD = "bad"


@dataclass(frozen=True, slots=True)
class CameraVerdict:
    """reprojection_px, cm: distance of the shirt in the picture from the body of all cameras together; visible_share:
    share of the frames with a person in which this camera saw them; dropped: share of its frames lost."""

    camera: str
    grade: Grade
    reprojection_px: float
    cm: float
    match: float
    visible_share: float
    dropped: float
    rate_hz: float
    problem: Problem | None


@dataclass(frozen=True, slots=True)
class Delivery:
    """A camera's frames during the check, its rate and the requested rate.

    lost: before they reached this program; late: arrived after their frame set; slow: why this machine is too slow, and
    a remedy; then the machine, not the camera, is the cause of both."""

    received: int
    lost: int
    rate_hz: float
    asked_hz: float
    width_px: int
    late: int = 0
    slow: tuple[str, str] | None = None

    @property
    def dropped_share(self) -> float:
        """Share of frames that never arrived."""
        return self.lost / max(self.received + self.lost, 1)

    @property
    def too_late(self) -> float:
        """Share of frames that arrived too late."""
        return self.late / max(self.received + self.lost, 1)


def camera_verdict(
    camera: str, measures: Sequence[Measure], delivery: Delivery, has_shirt: bool = True
) -> CameraVerdict:
    """Agreement of this camera with the others' body, and a remedy where it is poor. Without a shirt the body's
    outline is compared, which clothes and hair widen."""
    wide = 1.0 if has_shirt else _OUTLINE_WIDER
    target = "shirt" if has_shirt else "body"
    own = [m.cameras[camera] for m in measures if camera in m.cameras]
    visible_share = len(own) / max(len(measures), 1)
    px, cm, match = _middle(own)
    scaled_px = px * _WIDTH_PX / delivery.width_px
    judged = [
        (
            _grade(scaled_px, wide * GOOD_PX, wide * BAD_PX),
            _ROOM.format(target, f"{px:.1f} px"),
            _ROOM_FIX,
        ),
        (
            _grade(cm, wide * GOOD_CM, wide * BAD_CM),
            _ROOM.format(target, f"{cm:.1f} cm"),
            _ROOM_FIX,
        ),
        (
            _grade(1.0 - match, 1.0 - GOOD_MATCH, 1.0 - BAD_MATCH),
            f"only {100 * match:.0f} % of the shirt has its colours"
            if has_shirt
            else f"only {100 * match:.0f} % of the body is seen where it is drawn",
            "do the step Colour again, in the light as it is now"
            if has_shirt
            else "wear what differs from the room behind you, or turn the light up",
        ),
        *_of_delivery(delivery),
    ]
    if not own:
        judged = [
            (Grade.BAD, f"it did not see the {target}", "turn it to the person, then do Room again")
        ]
    grades = list(Grade)
    worst, what, fix = max(judged, key=lambda entry: grades.index(entry[0]))
    problem = None if worst is Grade.GOOD else Problem(what, camera, fix)
    return CameraVerdict(
        *(camera, worst, px, cm, match, visible_share, delivery.dropped_share, delivery.rate_hz),
        problem,
    )


def _of_delivery(delivery: Delivery) -> list[tuple[Grade, str, str]]:
    """Grade, problem and remedy of each figure. A machine that is too slow reads frames late that came in time."""
    lost = f"{100 * delivery.dropped_share:.0f} % of its frames are lost"
    late = f"{100 * delivery.too_late:.0f} % of its frames come too late"
    rate = f"{delivery.rate_hz:.0f} pictures a second, asked for {delivery.asked_hz:.0f}"
    lost_fix = "the camera or its USB bus loses them: use another USB port, without a hub"
    late_fix = (
        "give all cameras the same frame rate, and a camera in the network a better connection"
    )
    rate_fix = "more light, a shorter exposure, or a lower mode in the step Cameras"
    if delivery.slow is not None:
        why, fix = delivery.slow
        lost, late, rate = (f"{text}: this machine is {why}" for text in (lost, late, rate))
        lost_fix = late_fix = rate_fix = fix
    is_fast = delivery.rate_hz >= GOOD_RATE * delivery.asked_hz
    return [
        (_grade(delivery.dropped_share, GOOD_DROPPED, BAD_DROPPED), lost, lost_fix),
        (_grade(delivery.too_late, GOOD_DROPPED, BAD_DROPPED), late, late_fix),
        (Grade.GOOD if is_fast else Grade.DOUBTFUL, rate, rate_fix),
    ]


# Limits for shifts of an outline, relative to the shirt's patches: with the true rig they are 1 to 4 px and 0.3 to 2.0 cm,
# with a camera turned up by 1 degree 3 to 7 px, by 2 degrees 5 to 11 px.
_OUTLINE_WIDER = 1.6
_ROOM = "the {} is seen {} from where the other cameras have it"
_ROOM_FIX = "do the step Room again; the camera may have been moved"


def room_problems(
    measures: Sequence[Measure], hips_m: float, floor_known: bool
) -> tuple[Problem, ...]:
    """Contradictions to an upright person of the typed stature; `hips_m`: their height in the T-pose."""
    if not measures:
        return ()
    lean_rad = float(np.median([m.upright_rad for m in measures]))
    height_m = float(np.median([m.hips_m for m in measures]))
    scale = float(np.median([np.median(m.lengths) for m in measures]))
    problems = []
    if lean_rad > _LEAN_RAD:
        problems.append(
            Problem(
                f"the person leans by {math.degrees(lean_rad):.0f} degrees",
                "the floor",
                "lay the board flat on the floor and do the step Room again",
            )
        )
    if floor_known and abs(height_m - hips_m) > _FLOOR_M:
        way = "above" if height_m > hips_m else "below"
        problems.append(
            Problem(
                f"the person stands {100 * abs(height_m - hips_m):.0f} cm {way} the floor",
                "the floor",
                "lay the board on the floor where you stand and do the step Room again",
            )
        )
    if abs(scale - 1.0) > _SCALE:
        way = "larger" if scale > 1.0 else "smaller"
        problems.append(
            Problem(
                f"the person comes out {100 * abs(scale - 1.0):.0f} % {way} than the stature typed",
                "the scale",
                "check the stature, and the size of the board's squares with a ruler",
            )
        )
    return tuple(problems)


def verdict_json(verdict: CameraVerdict) -> Mapping[str, object]:
    """As the page shows it; None for figures without a measurement."""

    def figure(value: float, digits: int) -> float | None:
        return round(value, digits) if math.isfinite(value) else None

    return {
        "camera": verdict.camera,
        "grade": verdict.grade.value,
        "reprojection_px": figure(verdict.reprojection_px, 1),
        "cm": figure(verdict.cm, 1),
        "match": figure(verdict.match, 2),
        "seen": round(verdict.visible_share, 2),
        "dropped": round(verdict.dropped, 3),
        "rate_hz": round(verdict.rate_hz, 1),
    }


def _middle(own: Sequence[CameraMeasure]) -> tuple[float, float, float]:
    """Median of px, cm and match, robust against moments of trouble."""
    if not own:
        return math.nan, math.nan, math.nan
    px = float(np.median([np.linalg.norm(measure.shift_px) for measure in own]))
    cm = 100.0 * float(np.median([measure.shift_m for measure in own]))
    return px, cm, float(np.median([measure.match for measure in own]))


def _grade(value: float, good: float, bad: float) -> Grade:
    if value <= good:
        return Grade.GOOD
    return Grade.DOUBTFUL if value <= bad else Grade.BAD
