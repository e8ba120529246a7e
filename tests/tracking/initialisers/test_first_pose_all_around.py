"""The first pose before cameras all around: keypoints tell a front from a back, and a place tells who was tracked before."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.clock import nanoseconds
from mocapd.fit.fit_params import FitParams
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.floor_term import FloorTerm
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.geometry import rotations
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.regions import silhouette_labels
from mocapd.tracking.initialisers import person_search
from mocapd.tracking.initialisers.keypoint_initialiser import KeypointInitialiser
from mocapd.tracking.initialisers.person_search import PersonSearch
from mocapd.types import Floats
from mocapd.vision.foreground_kernels import BEFORE
from tests.geometry.rigs import ring
from tests.tracking.initialisers.test_keypoint_pose import seen_by
from tests.tracking.initialisers.test_standing_initialiser import BODY, FACTOR, turned

pytestmark = pytest.mark.kernels

CAMERAS = ring(4, 3.2)
FITTER = Fitter(BODY, silhouette_labels(BODY), CAMERAS, [FACTOR] * 4, FitParams(iterations=6))
ACROSS = [INDEX["leftUpperLeg"], INDEX["rightUpperLeg"]]


def facing_rad(joints_m: Floats) -> float:
    left, right = joints_m[ACROSS]
    return float(np.arctan2(right[2] - left[2], left[0] - right[0]))


class Keypoints:
    """Stands in for the detectors and their term: sharp keypoints of a body that faces this way."""

    is_measured = False
    rays = ()  # for a pose from them alone there are too few

    def __init__(self, true_rad: float) -> None:
        self._true_rad = true_rad

    def detector(self, *_: object) -> Callable[[int], int]:
        return int

    def term(self, _: object, __: Iterable[int]) -> tuple["Keypoints"]:
        return (self,)

    def head_spreads_m(self, _: int) -> list[float]:
        return [0.04]

    def turn_rad(self, joints_m: Floats) -> float:
        off = self._true_rad - facing_rad(joints_m)
        return float(np.angle(np.exp(1j * off)))

    def add(self, *_: object) -> float:
        return 0.0


def search_among(people: Sequence[MotionState], keypoints: Keypoints) -> PersonSearch:
    """Before cameras all around."""
    views = []
    for drawing in FITTER.drawings:
        foreground = np.zeros((240, 320), np.uint8)
        for state in people:
            roi = drawing.region(state, 0.0, 10)
            assert roi is not None
            x0, y0, x1, y1 = roi
            foreground[y0:y1, x0:x1][drawing.render(state, 0.0, roi) > 0] = BEFORE
        views.append(SimpleNamespace(foreground=foreground, image_scale=FACTOR, name="a camera"))

    def nothing(*_: object) -> None: ...

    shown: Any = SimpleNamespace(
        each=views, present=dict.fromkeys(range(4), 0.0), are_new=False, mark_body=nothing, update_foreground=nothing,
        remove_ghosts=nothing,
    )  # fmt: skip
    detectors: Any = keypoints
    floor, p = FloorTerm(BODY), ClothesParams()
    by_keypoints = KeypointInitialiser(
        FITTER, floor, detectors, shown, CAMERAS, p.start, p.keypoint_start
    )
    return PersonSearch(FITTER, floor, detectors, shown, CAMERAS, by_keypoints, p, lambda: 0)


def first_pose(search: PersonSearch, state: MotionState, t_ns: int = 0) -> MotionState | None:
    found = search.look(state.factors, state.information, t_ns)
    return None if found is None else found[0].state


@pytest.mark.parametrize("yaw_rad", [-2.4, -0.8, 0.7, 2.2])
def test_the_first_pose_faces_as_keypoints_do(yaw_rad: float) -> None:
    state = turned(yaw_rad)
    for seen in (yaw_rad, yaw_rad + np.pi):  # whichever way the outlines led
        found = first_pose(search_among([state], Keypoints(seen)), state)
        assert found is not None
        off_rad = np.angle(np.exp(1j * (facing_rad(FITTER.joints(found)[0]) - seen)))
        assert abs(off_rad) < 1.2


@pytest.mark.parametrize(("explained", "is_turned"), [(0.76, True), (0.68, False)])
def test_a_first_pose_that_faces_beside_its_keypoints_is_turned_if_that_agrees_better(
    monkeypatch: pytest.MonkeyPatch, explained: float, is_turned: bool
) -> None:
    """Somebody was found 20 degrees askew, with too little agreement to be believed, for two seconds."""
    state = turned(0.7)
    search = search_among([state], Keypoints(0.7 + 0.35))
    fit: Any = SimpleNamespace(state=state, explained=0.70)
    better: Any = SimpleNamespace(state=turned(0.7 + 0.35), explained=explained)
    monkeypatch.setattr(person_search, "fit_to_blobs", lambda *_: better)
    candidate: Any = SimpleNamespace(views=(), person=SimpleNamespace(blobs=range(4)))
    found = search._as_person(fit, candidate)
    assert found is (better if is_turned else fit)


@pytest.mark.parametrize(("explained", "is_moved"), [(0.76, True), (0.68, False)])
def test_an_arm_that_is_seen_elsewhere_is_moved_there_if_that_agrees_better(
    monkeypatch: pytest.MonkeyPatch, explained: float, is_moved: bool
) -> None:
    """A first pose with one arm folded taught the tracker wrong colours for good."""
    state = turned(0.7)
    local = state.local_xyzw.copy()
    local[INDEX["leftLowerArm"]] = rotations.exp(np.array([0.0, -2.4, 0.0]))
    keypoints: Any = SimpleNamespace(
        detector=lambda *_: int,
        term=lambda *_: (JointTerm(BODY, [seen_by(c, FITTER.joints(state)[0]) for c in CAMERAS]),),
    )
    search = search_among([state], keypoints)
    fit: Any = SimpleNamespace(state=replace(state, local_xyzw=local), explained=0.70)
    better: Any = SimpleNamespace(state=state, explained=explained)
    starts: list[MotionState] = []

    def refit(_: object, __: object, start: MotionState, *___: object) -> object:
        starts.append(start)
        return better

    monkeypatch.setattr(person_search, "fit_to_blobs", refit)
    candidate: Any = SimpleNamespace(views=(), person=SimpleNamespace(blobs=range(4)))
    assert search._as_person(fit, candidate) is (better if is_moved else fit)
    off_m = FITTER.joints(starts[0])[0] - FITTER.joints(state)[0]
    assert np.linalg.norm(off_m, axis=1).max() < 0.05


def test_who_was_tracked_a_moment_ago_is_not_taken_for_somebody_else() -> None:
    """The one who was tracked has left the cameras' view."""
    other = turned(0.7)
    search = search_among([other], Keypoints(0.7))
    search.on_body(other.root_m + np.array([2.5, 0.0, 0.0]), 0)
    assert first_pose(search, other, nanoseconds(1.0)) is None
    found = first_pose(search, other, nanoseconds(2.0))  # by then they may have walked here
    assert found is not None
    assert np.linalg.norm(found.root_m - other.root_m) < 0.1
    search.on_body(other.root_m + np.array([0.5, 0.0, 0.0]), nanoseconds(3.0))
    assert first_pose(search, other, nanoseconds(3.5)) is not None
    search.on_body(other.root_m + np.array([2.5, 0.0, 0.0]), nanoseconds(90.0))
    assert first_pose(search, other, nanoseconds(4.0)) is not None  # a clock that was set back


def test_of_two_people_the_one_is_found_again_who_was_tracked() -> None:
    """Also where the other one agrees better with the pictures."""
    one = turned(0.7)
    other = replace(one, root_m=one.root_m + np.array([-1.3, 0.0, 0.4]))
    for tracked in (one, other):
        search = search_among([one, other], Keypoints(0.7))
        search.on_body(tracked.root_m + np.array([0.2, 0.0, -0.1]), 0)
        # a fit that agrees less well counts when it is found once more
        tries = (first_pose(search, one, nanoseconds(t_s)) for t_s in (1.5, 1.8))
        found = next((pose for pose in tries if pose is not None), None)
        assert found is not None
        assert np.linalg.norm(found.root_m - tracked.root_m) < 0.2


def test_who_may_be_a_person_is_confirmed_by_the_next_frame_set() -> None:
    state = turned(0.7)
    search = search_among([state], Keypoints(0.7))
    search._params = replace(search._params, accept_explained=2.0)  # one search never does
    assert first_pose(search, state) is None
    assert search.times.is_due(nanoseconds(0.02))
    assert first_pose(search, state, nanoseconds(0.02)) is not None


def test_who_is_never_confirmed_is_not_looked_for_in_every_frame_set() -> None:
    state = turned(0.7)
    search = search_among([state], Keypoints(0.7))
    search._params = replace(search._params, accept_explained=2.0, same_place_m=-1.0)
    looked = [
        first_pose(search, state, nanoseconds(0.02 * k))
        for k in range(50)
        if search.times.is_due(nanoseconds(0.02 * k))
    ]
    assert 5 <= len(looked) <= 12
    assert not any(looked)
