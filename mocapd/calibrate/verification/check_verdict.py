"""Turns five seconds of tracking into a verdict on each camera and on the room."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.calibrate.verification.check_measure import CameraMeasure, Measure
from mocapd.calibrate.verification.delivery import Delivery, Grade, delivery_judgements, grade
from mocapd.errors import Problem

GOOD_PX, BAD_PX = 2.5, 6.0  # of a picture 640 px wide
GOOD_CM, BAD_CM = 1.5, 3.5
GOOD_MATCH, BAD_MATCH = 0.6, 0.4
_WIDTH_PX = 640
_LEAN_RAD = math.radians(20.0)
_FLOOR_M = 0.12
_SCALE = 0.08


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


def camera_verdict(
    camera: str,
    measures: Sequence[Measure],
    delivery: Delivery,
    width_px: int,
    has_shirt: bool = True,
) -> CameraVerdict:
    """Agreement of this camera with the others' body, and a remedy where it is poor. Without a shirt the body's
    outline is compared, which clothes and hair widen. width_px: of its pictures."""
    wide = 1.0 if has_shirt else _OUTLINE_WIDER
    target = "shirt" if has_shirt else "body"
    own = [m.cameras[camera] for m in measures if camera in m.cameras]
    visible_share = len(own) / max(len(measures), 1)
    px, cm, match = _middle(own)
    scaled_px = px * _WIDTH_PX / width_px
    judged = [
        (
            grade(scaled_px, wide * GOOD_PX, wide * BAD_PX),
            _ROOM.format(target, f"{px:.1f} px"),
            _ROOM_FIX,
        ),
        (
            grade(cm, wide * GOOD_CM, wide * BAD_CM),
            _ROOM.format(target, f"{cm:.1f} cm"),
            _ROOM_FIX,
        ),
        (
            grade(1.0 - match, 1.0 - GOOD_MATCH, 1.0 - BAD_MATCH),
            f"only {100 * match:.0f} % of the shirt has its colours"
            if has_shirt
            else f"only {100 * match:.0f} % of the body is seen where it is drawn",
            "do the step Colour again, in the light as it is now"
            if has_shirt
            else "wear what differs from the room behind you, or turn the light up",
        ),
        *delivery_judgements(delivery),
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


# Limits for shifts of an outline, relative to the shirt's patches: with the true rig they are 1 to 4 px and 0.3 to 2.0 cm,
# with a camera turned up by 1 degree 3 to 7 px, by 2 degrees 5 to 11 px.
_OUTLINE_WIDER = 1.6
_ROOM = "the {} is seen {} from where the other cameras have it"
_ROOM_FIX = "do the step Room again; the camera may have been moved"


def room_problems(
    measures: Sequence[Measure], hips_m: float, floor_known: bool
) -> Iterator[Problem]:
    """Contradictions to an upright person of the typed stature; `hips_m`: their height in the T-pose."""
    if not measures:
        return
    lean_rad = float(np.median([m.upright_rad for m in measures]))
    height_m = float(np.median([m.hips_m for m in measures]))
    scale = float(np.median([np.median(m.lengths) for m in measures]))
    if lean_rad > _LEAN_RAD:
        yield Problem(
            f"the person leans by {math.degrees(lean_rad):.0f} degrees",
            "the floor",
            "lay the board flat on the floor and do the step Room again",
        )
    if floor_known and abs(height_m - hips_m) > _FLOOR_M:
        way = "above" if height_m > hips_m else "below"
        yield Problem(
            f"the person stands {100 * abs(height_m - hips_m):.0f} cm {way} the floor",
            "the floor",
            "lay the board on the floor where you stand and do the step Room again",
        )
    if abs(scale - 1.0) > _SCALE:
        way = "larger" if scale > 1.0 else "smaller"
        yield Problem(
            f"the person comes out {100 * abs(scale - 1.0):.0f} % {way} than the stature typed",
            "the scale",
            "check the stature, and the size of the board's squares with a ruler",
        )


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
