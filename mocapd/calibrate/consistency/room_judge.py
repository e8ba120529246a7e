"""Combines the findings of people with the room's points: camera places and calibration of the pictures."""

from collections.abc import Sequence
from itertools import combinations

from mocapd.calibrate.bump.changed_places import (
    PlacesVerdict,
    matching_points,
    places_by_matches,
    room_features,
)
from mocapd.calibrate.consistency.findings import CaptureFinding, Mistake
from mocapd.calibrate.consistency.hypotheses import exchanged_finding
from mocapd.calibrate.consistency.room_points import PictureChange, RoomVerdict, judge_room
from mocapd.types import Bytes, Camera


def with_the_room(
    cameras: Sequence[Camera],
    pictures: Sequence[Bytes | None],
    findings: tuple[CaptureFinding, ...],
) -> tuple[CaptureFinding, ...]:
    """The findings of people, without those that the room's points contradict; if there are none, the room's own.

    pictures (h,w,3) BGR: each camera's at one time, None where there is none.
    """
    concerned = {name for finding in findings for name in finding.cameras}
    features = [None if picture is None else room_features(picture) for picture in pictures]
    out = list(findings)
    worst: tuple[RoomVerdict, tuple[str, str]] | None = None
    for i, j in combinations(range(len(cameras)), 2):
        names, a, b = (cameras[i].name, cameras[j].name), features[i], features[j]
        if (findings and not concerned & set(names)) or a is None or b is None:
            continue
        pair, px = (cameras[i], cameras[j]), matching_points(a, b)
        places = places_by_matches(pair, px)
        if places is PlacesVerdict.RIGHT:
            out = [
                one
                for one in out
                if not set(names) <= set(one.cameras)
                and one.cameras not in ((names[0],), (names[1],))
            ]
        elif findings:
            continue
        elif places is PlacesVerdict.CHANGED:
            return (exchanged_finding(*names),)
        else:
            verdict = judge_room(pair, px)
            if verdict.is_contradiction and (worst is None or verdict.matches > worst[0].matches):
                worst = verdict, names
    return tuple(out) if worst is None else (_finding(*worst),)


def _finding(verdict: RoomVerdict, names: tuple[str, str]) -> CaptureFinding:
    change = verdict.change
    if change is None:
        return CaptureFinding(
            Mistake.CONTRADICTION,
            names,
            f"of {verdict.free} points of the room that {names[0]!r} and {names[1]!r} both see, {verdict.given} fit the rig",
            "was a camera moved, or its picture cut or zoomed? Calibrate the room again",
        )
    those = tuple(names[i] for i in change.cameras)
    shown = f"the pictures of {' or '.join(map(repr, those))}"
    because = f"so {change.count} of {verdict.matches} points of the room fit, and {verdict.given} as given"
    mistake, what, fix = _change_words(change)
    return CaptureFinding(mistake, those, f"{shown} are {what}: {because}", fix)


def _change_words(change: PictureChange) -> tuple[Mistake, str, str]:
    if change.is_mirrored:
        return (
            Mistake.MIRRORED,
            "mirrored",
            "switch off mirroring where they are recorded, or mirror the video back",
        )
    if change.is_turned:
        return (
            Mistake.TURNED,
            "turned by 180 degrees from how they were calibrated",
            "turn the video back, or calibrate again with the camera as it is mounted",
        )
    fix = (
        "were they cut, zoomed or letterboxed after calibration? Record as then, or calibrate again"
    )
    if change.is_central:
        size_word = "larger" if change.scale > 1.0 else "smaller"
        times = max(change.scale, 1.0 / change.scale)
        return (
            Mistake.ZOOMED,
            f"about {times:.1f} times {size_word} than their focal length makes them",
            fix,
        )
    return Mistake.ZOOMED, "cut, zoomed or shifted from how they were calibrated", fix
