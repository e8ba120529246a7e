"""What the simulated person wears: plain cloth, a jacket that comes and goes, a face; and who else is there."""

from functools import cache
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX
from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project
from mocapd.sim.person.dress_kernels import FLAT, REACH, SLEEVE, TRUNK, jacket_share, surface_colour
from mocapd.sim.person.figure import Figure, build_figure, posed_figure
from mocapd.sim.person_spec import Clothes, Jacket, Weave
from mocapd.sim.renderer import CameraRenderer, camera_renderers
from mocapd.sim.scenario import scenario_from_dict
from mocapd.sim.world import World
from mocapd.types import Bytes, Floats
from tests.sim.small import scenario, table

SHAPE = mean_shape(1.75)
RED, WHITE = (180, 40, 40), (230, 230, 230)
JACKET = {"jacket": {"srgb": [40, 50, 60]}}
ON_AND_OFF = [
    {"t_s": 0.4, "jacket": 1.0, "over_s": 0.4},
    {"t_s": 1.2, "jacket": 0.0, "over_s": 0.4},
]


@cache
def figure_in(whole: bool = False, **clothes: Any) -> Figure:
    return build_figure(SHAPE, Clothes(**clothes), seed=1, whole=whole)


def colour(figure: Figure, place: Floats, rule: int, jacket: float = 0.0) -> Floats:
    """Of a place in the T-pose on a part of that kind."""
    rgb = np.zeros(3)
    x, y, z = place
    under = rule if figure.dress.under_jacket.any() else FLAT
    surface_colour(x, y, z, rule, under, 0, jacket, figure.dress.outfits, rgb)
    return rgb


def forearm(share: float) -> Floats:
    """A place so far along the left forearm in the T-pose."""
    rest = figure_in().skeleton.rest_m
    elbow, wrist = rest[INDEX["leftLowerArm"]], rest[INDEX["leftHand"]]
    place: Floats = elbow + share * (wrist - elbow)
    return place


def renderer_of(**changes: Any) -> CameraRenderer:
    return camera_renderers(World(scenario(**changes)), samples=1)[0]


@given(st.floats(1.0, 1.3), st.integers(-3, 3))
def test_stripes_repeat_with_their_period_and_have_two_colours(y: float, periods: int) -> None:
    weave = Weave(pattern="stripes", srgb=WHITE, period_m=0.08)
    figure = figure_in(shirt="plain", top_srgb=RED, top_weave=weave)
    here, there, between = (
        colour(figure, np.array([0.05, y + shift, 0.1]), TRUNK)
        for shift in (0.0, 0.08 * periods, 0.04)
    )
    edge = (y / 0.04) % 1.0
    if 1e-6 < edge < 1.0 - 1e-6:  # at an edge rounding may decide
        np.testing.assert_array_equal(here, there)
        assert np.abs(here - between).max() > 0.2


def test_short_sleeves_leave_the_forearm_bare() -> None:
    skin = colour(figure_in(shirt="plain", sleeves="short", top_srgb=RED), forearm(0.5), SLEEVE)
    cloth = colour(figure_in(shirt="plain", top_srgb=RED), forearm(0.5), SLEEVE)
    assert skin[1] > 3 * cloth[1]
    shoulder = SHAPE.stature_m * np.array([0.11, 0.81, 0.0])
    short, long = (
        colour(figure_in(shirt="plain", sleeves=s, top_srgb=RED), shoulder, SLEEVE)
        for s in ("short", "long")
    )
    np.testing.assert_array_equal(short, long)


def test_plain_clothes_have_no_patches() -> None:
    renderer = renderer_of(clothes={"shirt": "plain"})
    patch, mask = renderer.labels(World(scenario()).pose(0.0))
    assert mask.any()
    assert not patch.any()


@settings(max_examples=30)
@given(st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_jacket_that_is_further_on_covers_more(a: float, b: float) -> None:
    less, more = sorted((a, b))
    x = np.linspace(-0.7, 0.7, 200)
    assert (jacket_share(x, 0.7, less) <= jacket_share(x, 0.7, more) + 1e-12).all()
    assert not jacket_share(x, 0.7, 0.0).any()
    np.testing.assert_allclose(jacket_share(x, 0.7, 1.0), 1.0)


def test_a_jacket_stands_off_the_body_by_its_thickness_and_no_more_when_off() -> None:
    figure = figure_in(jacket=Jacket(thickness_m=0.02))
    pose = World(scenario()).pose(0.3)
    bare, on = (posed_figure(figure, pose, level) for level in (0.0, 1.0))
    moved = np.linalg.norm(on - bare, axis=1)
    assert 0.01 < np.median(moved[figure.jacket_over]) < 0.03
    away = np.setdiff1d(np.arange(len(moved)), figure.jacket_over)
    assert not moved[away].any()
    # half of it is on: the right arm, and not the left one
    half = np.linalg.norm(posed_figure(figure, pose, 0.5) - bare, axis=1)
    x = figure.dress.rest_m[:, 0]
    reach = figure.dress.outfits[0, REACH]
    over = np.isin(np.arange(len(x)), figure.jacket_over)
    assert (half[over & (x < -0.4 * reach)] > 0.0).all()
    assert not half[over & (x > 0.4 * reach)].any()


def test_the_jacket_hides_the_shirt_and_gives_it_back() -> None:
    s = scenario(clothes=JACKET | {"events": ON_AND_OFF})
    world, renderer = World(s), camera_renderers(World(s), samples=1)[0]
    assert [world.jacket(t) for t in (0.0, 0.6, 1.0, 1.4, 1.8)] == pytest.approx(
        [0.0, 0.5, 1.0, 0.5, 0.0]
    )
    assert world.jacket(s.loop_s - 1e-6) == pytest.approx(world.jacket(0.0))
    shown = [int((renderer.labels_at(t)[0] > 0).sum()) for t in (0.1, 0.6, 1.0, 1.9)]
    assert shown[0] > 300
    assert 0.05 * shown[0] < shown[1] < 0.8 * shown[0]  # the arms are crossed by then
    assert shown[2] == 0
    assert shown[3] > 300
    # and the picture shows cloth of one dark colour where the patches were
    patch, _, _ = renderer.labels_at(0.0)
    frames = [renderer.frame(round(30 * t)) for t in (1.0, 0.0)]
    inside = cv2.erode((patch > 0).astype(np.uint8), np.ones((3, 3), np.uint8)) > 0
    colourful = [np.ptp(frame[inside].astype(int), axis=1).mean() for frame in frames]
    assert colourful[0] < 0.5 * colourful[1]


def test_events_need_a_jacket_and_rising_times() -> None:
    for clothes, said in (
        ({"events": ON_AND_OFF}, "no jacket"),
        (JACKET | {"events": ON_AND_OFF[::-1]}, "do not rise"),
    ):
        with pytest.raises(ConfigError, match=said):
            scenario_from_dict(table(clothes=clothes))


def _close_up(yaw_deg: float) -> tuple[Bytes, Floats]:
    """A picture of the head, turned so far, and where eye, cheek and the other eye are in it [px]."""
    camera: dict[str, Any] = {
        "name": "near",
        "position_m": [0.0, 1.6, 0.9],
        "look_at_m": [0.0, 1.6, 0.0],
    }
    camera |= {"size_px": [160, 160], "shutter_s": 0.0, "gain": 2.0}
    s = scenario(
        cameras=[camera],
        body={"whole": True},
        clothes={"shirt": "plain"},
        motion={"keyframes": [{"t_s": 0.0, "yaw_deg": yaw_deg}], "sway_deg": 0.0},
    )
    world, renderer = World(s), camera_renderers(World(s), samples=1)[0]
    state, neck = world.at(0.0), INDEX["neck"]
    places = 1.75 * np.array(
        [[0.0178, 0.084, 0.066], [0.024, 0.062, 0.06], [-0.0178, 0.084, 0.066]]
    )
    at = state.joints_m[neck] + rotations.rotate(state.pose.quats_xyzw[INDEX["head"]], places)
    return renderer.frame(0), project(renderer.camera, at)


@pytest.mark.parametrize("yaw_deg", [-25.0, 0.0, 25.0])
def test_the_face_has_eyes_that_turn_with_the_head(yaw_deg: float) -> None:
    picture, places = _close_up(yaw_deg)

    def darkest(at: Floats) -> int:
        x, y = np.round(at).astype(int)
        return int(picture[y - 4 : y + 5, x - 4 : x + 5].max(axis=2).min())

    eye, cheek, other = (darkest(at) for at in places)
    assert eye < 0.6 * cheek
    assert other < 0.6 * cheek


def test_a_head_seen_from_behind_has_no_face() -> None:
    picture, places = _close_up(180.0)
    x, y = np.round(places.mean(axis=0)).astype(int)
    hair = picture[y - 6 : y + 5, x - 8 : x + 9].max(axis=2).astype(int)
    assert hair.max() < 2 * hair.min()


def test_whole_legs_end_in_feet_that_hold_the_toes() -> None:
    s = scenario(body={"whole": True, "leg_girth": 1.1})
    renderer, state = camera_renderers(World(s), samples=1)[0], World(s).at(0.0)
    _, mask = renderer.labels(state.pose)
    grown = cv2.dilate(mask, np.ones((3, 3), np.uint8))
    x, y = np.round(project(renderer.camera, state.joints_m)).astype(int).T
    assert (grown[y, x] == 255).all()


BEHIND = {
    "motion": {"keyframes": [{"t_s": 0.0, "pose": "relaxed", "at_m": [0.9, -1.2]}]},
    "body": {"whole": True},
}


def test_somebody_behind_is_drawn_and_labelled_as_another() -> None:
    alone, crowd = renderer_of(), renderer_of(others=[BEHIND])
    patch, mask, other = crowd.labels_at(0.2)
    patch_alone, mask_alone, nobody = alone.labels_at(0.2)
    assert not nobody.any()
    assert (other > 0).sum() > 100
    assert not (mask & other).any()
    # in front, the person is as without the other
    np.testing.assert_array_equal(patch, patch_alone)
    np.testing.assert_array_equal(mask, mask_alone)
    seen = np.abs(crowd.frame(6).astype(int) - alone.frame(6)).max(axis=2)
    inside = cv2.erode(other, np.ones((3, 3), np.uint8)) > 0
    assert np.mean(seen[inside] > 8) > 0.8
    # her own shadow may fall on the other, and nothing else changes
    assert not seen[cv2.dilate(other, np.ones((7, 7), np.uint8)) == 0].any()


def test_who_stands_in_front_hides_the_person() -> None:
    before = BEHIND | {
        "motion": {"keyframes": [{"t_s": 0.0, "pose": "relaxed", "at_m": [-0.5, 0.9]}]}
    }
    _, mask, other = renderer_of(others=[before]).labels_at(0.2)
    _, mask_alone, _ = renderer_of().labels_at(0.2)
    hidden = (mask_alone > 0) & (other > 0)
    assert hidden.sum() > 100
    assert not mask[hidden].any()


def test_the_person_is_away_while_the_others_stay() -> None:
    changes: dict[str, Any] = {"absences": [{"from_s": 0.5, "to_s": 1.0}], "others": [BEHIND]}
    world, renderer = World(scenario(**changes)), renderer_of(**changes)
    assert [world.at(t).person_present for t in (0.4, 0.5, 0.99, 1.0, 2.6)] == [
        True, False, False, True, False,
    ]  # fmt: skip
    _, mask, other = renderer.labels_at(0.7)
    assert not mask.any()
    assert other.any()
    assert renderer.frame(21).std() > 0.0


def test_a_foot_goes_where_a_keyframe_puts_it() -> None:
    keys = [
        {"t_s": 0.0, "pose": "relaxed"},
        {"t_s": 0.7, "left_foot_m": [0.1, 0.3, 0.4]},
        {"t_s": 1.4},
    ]
    world = World(scenario(motion={"keyframes": keys, "sway_deg": 0.0}))
    rest, raised = (world.at(t) for t in (0.0, 0.7))
    foot, other = INDEX["leftFoot"], INDEX["rightFoot"]
    place = world.skeleton.rest_m[foot] + [0.1, 0.3, 0.4]
    np.testing.assert_allclose(raised.joints_m[foot], place, atol=0.02)
    assert raised.joints_m[other, 1] == pytest.approx(rest.joints_m[other, 1], abs=0.05)
    np.testing.assert_allclose(world.at(2.0).joints_m, rest.joints_m, atol=1e-9)
