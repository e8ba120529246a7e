"""Candidates in the hull: a person apart from the light on the floor and from other people."""

from dataclasses import replace

import numpy as np

from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project
from mocapd.tracking.cues.clothes.clothes_params import HullStartParams
from mocapd.tracking.initialisers.hull_candidates import HullCandidate, hull_candidates
from mocapd.types import Bytes, Floats
from mocapd.vision.foreground_kernels import BACKGROUND, BEFORE, UNKNOWN
from tests.vision.hull.ring_of_cameras import FIGURE, ring, silhouette

CAMERAS = ring(4)
PARAMS = HullStartParams()
ELSEWHERE_M = np.array([-1.1, 0.0, 0.5])
OTHER = [(centre_m + ELSEWHERE_M, radii_m) for centre_m, radii_m in FIGURE]
FLOOR = [(np.array([0.3, 0.0, 0.2]), np.array([0.9, 0.01, 0.7]))]  # under the feet, and around


def foregrounds(things: list[tuple[Floats, Floats]], n: int = 4) -> dict[int, Bytes]:
    return {
        i: np.where(silhouette(camera, things) > 0, np.uint8(BEFORE), np.uint8(BACKGROUND))
        for i, camera in enumerate(CAMERAS[:n])
    }


def candidates(shown: dict[int, Bytes]) -> list[HullCandidate]:
    found = hull_candidates(shown, CAMERAS, [1] * len(CAMERAS), PARAMS)
    assert found is not None
    return found


def share_of(one: HullCandidate, camera: int, things: list[tuple[Floats, Floats]]) -> float:
    """Share of a silhouette that is in a candidate's blob."""
    blob, true = one.person.blobs[camera], silhouette(CAMERAS[camera], things) > 0
    x0, y0, x1, y1 = blob.roi
    mine = np.zeros_like(true)
    mine[y0:y1, x0:x1] = blob.mask > 0
    return float((mine & true).sum() / true.sum())


def test_somebody_is_found_where_they_stand() -> None:
    (one,) = candidates(foregrounds(FIGURE))
    assert np.linalg.norm(one.person.place_m) < 0.1
    assert abs(one.middle_m[1] - 0.8) < 0.1
    for camera in range(4):
        assert share_of(one, camera, FIGURE) > 0.97
        rows = np.flatnonzero(silhouette(CAMERAS[camera], FIGURE).any(axis=1))
        assert one.person.blobs[camera].bottom >= rows[-1]  # the feet, too


def test_light_on_the_floor_is_no_part_of_somebody() -> None:
    """In each picture it is one blob with the feet."""
    (one,) = candidates(foregrounds([*FIGURE, *FLOOR]))
    assert np.linalg.norm(one.person.place_m) < 0.1
    for camera in range(4):
        assert share_of(one, camera, FIGURE) > 0.97
        assert share_of(one, camera, FLOOR) < 0.6


def test_legs_that_two_cameras_hardly_show_belong_to_somebody() -> None:
    """Trousers in the colour of the lawn."""
    shown = foregrounds(FIGURE)
    for camera in (0, 2):
        legs = silhouette(CAMERAS[camera], FIGURE[1:]) > 0
        legs[::3] = False  # a third of their rows remains
        shown[camera][legs] = BACKGROUND
    (one,) = candidates(shown)
    for camera in (1, 3):
        assert share_of(one, camera, FIGURE) > 0.9


def test_somebody_whom_one_of_three_cameras_does_not_show_is_found_by_the_others() -> None:
    about = rotations.to_matrix(rotations.exp(np.array([0.0, np.radians(100.0), 0.0])))
    away = replace(CAMERAS[2], R=about @ CAMERAS[2].R, t_m=about @ CAMERAS[2].t_m)
    shown = foregrounds(FIGURE, 2) | {2: np.full_like(foregrounds(FIGURE)[2], BACKGROUND)}
    found = hull_candidates(shown, [*CAMERAS[:2], away], [1] * 3, PARAMS)
    assert found
    assert np.linalg.norm(found[0].person.place_m) < 0.3
    assert set(found[0].person.blobs) == {0, 1}


def test_two_people_are_two_where_one_hides_the_other() -> None:
    both = foregrounds([*FIGURE, *OTHER])
    places = {tuple(np.round(one.person.place_m, 1)): one for one in candidates(both)}
    here = min(places.values(), key=lambda one: float(np.linalg.norm(one.person.place_m)))
    there = min(
        places.values(), key=lambda one: float(np.linalg.norm(one.person.place_m - ELSEWHERE_M))
    )
    assert np.linalg.norm(here.person.place_m) < 0.1
    assert np.linalg.norm(there.person.place_m - ELSEWHERE_M) < 0.1
    apart = [
        i
        for i, camera in enumerate(CAMERAS)
        if abs(np.diff(project(camera, np.stack([np.zeros(3), ELSEWHERE_M]))[:, 0])[0]) > 80
    ]
    assert apart
    for camera in apart:
        assert share_of(here, camera, FIGURE) > 0.97
        assert share_of(here, camera, OTHER) < 0.1


def test_a_camera_whose_background_is_unknown_hinders_nobody() -> None:
    shown = foregrounds(FIGURE)
    shown[1] = np.full_like(shown[1], UNKNOWN)
    (one,) = candidates(shown)
    assert np.linalg.norm(one.person.place_m) < 0.1
    assert sorted(one.person.blobs) == [0, 2, 3]


def test_an_empty_room_has_nobody_and_two_cameras_no_hull() -> None:
    assert candidates(foregrounds([])) == []
    assert candidates(foregrounds(FLOOR)) == []
    assert hull_candidates(foregrounds(FIGURE, 2), CAMERAS, [1] * 4, PARAMS) is None
