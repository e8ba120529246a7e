"""Mistakes with rigs and videos, found by views of one person that do not agree."""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from mocapd.calibrate.consistency.findings import Mistake
from mocapd.calibrate.consistency.joint_scale import scaled_findings
from mocapd.calibrate.consistency.person_views import PersonView
from mocapd.calibrate.consistency.rig_judge import Stretch, judge
from mocapd.calibrate.consistency.view_agreement import mirror_view, upside_down, zoom_view
from mocapd.calibrate.consistency.world_judge import judge_world, turned_views
from mocapd.geometry.camera_model import centre, project, to_camera
from mocapd.types import Camera, Floats
from tests.geometry.rigs import looking_at, ring

# head, neck, hips, arms, legs, as in the network, of somebody 1.75 m tall who faces +z
STANDING = np.array(
    [
        [0.0, 1.62, 0.03], [0.0, 1.45, 0.0], [0.0, 0.95, 0.0],
        [0.17, 1.40, 0.0], [-0.17, 1.40, 0.0], [0.28, 1.14, 0.0], [-0.28, 1.14, 0.0],
        [0.30, 0.95, 0.22], [-0.32, 1.00, 0.22], [0.09, 0.90, 0.0], [-0.09, 0.90, 0.0],
        [0.10, 0.50, 0.06], [-0.10, 0.50, 0.06], [0.10, 0.09, 0.0], [-0.10, 0.09, 0.0],
    ]
)  # fmt: skip


def walking(times_s: Floats) -> Floats:
    """Joints (F,15,3) of somebody who walks about and waves."""
    out = np.repeat(STANDING[None], len(times_s), axis=0)
    out[:, 7] += 0.35 * np.stack([np.sin(3 * times_s), np.sin(2.3 * times_s), 0 * times_s], axis=1)
    out[:, 8] += 0.30 * np.stack([0 * times_s, np.sin(2.7 * times_s), np.cos(2 * times_s)], axis=1)
    at = np.stack([0.3 * np.sin(0.9 * times_s), 0 * times_s, 0.25 * np.sin(0.6 * times_s)], axis=1)
    return np.asarray(out + at[:, None])


def view(camera: Camera, times_s: Floats, seed: int) -> PersonView:
    points = walking(times_s)
    rng = np.random.default_rng(seed)
    px = project(camera, points) + rng.normal(0.0, 2.0, (*points.shape[:2], 2))
    depth = to_camera(camera, points)[..., 2]
    farther = depth - depth[:, 2:3] + rng.normal(0.0, 0.05, depth.shape)
    return PersonView(times_s, px, np.full(depth.shape, 1.0), farther, 0)


def stretches(cameras: Sequence[Camera]) -> list[list[list[PersonView]]]:
    spans = [np.arange(2.0 * k, 2.0 * k + 2.0, 1 / 15.0) for k in range(3)]
    return [
        [[view(camera, span, 10 * k + i)] for i, camera in enumerate(cameras)]
        for k, span in enumerate(spans)
    ]


def pair() -> tuple[Camera, ...]:
    return tuple(
        looking_at(name, np.array([x, 1.4, 2.6]), np.array([0.05, 1.0, 0.0]))
        for name, x in (("left", -1.2), ("right", 1.35))
    )


RIGS = {"pair": pair(), "ring": ring(4)}


@pytest.mark.parametrize("rig", RIGS)
def test_a_rig_that_fits_gives_no_finding(rig: str) -> None:
    cameras = RIGS[rig]
    verdict = judge(cameras, stretches(cameras))
    assert verdict.findings == ()
    assert verdict.off_m == 0.0
    assert judge_world(("a",), verdict.fits, 1.75) is None
    views = [[one[i][0] for one in stretches(cameras)] for i in range(len(cameras))]
    assert not [*turned_views(cameras, views)]


@pytest.mark.parametrize("rig", RIGS)
def test_exchanged_videos_are_named(rig: str) -> None:
    cameras = RIGS[rig]
    seen: list[Stretch] = [[one[1], one[0], *one[2:]] for one in stretches(cameras)]
    [finding] = judge(cameras, seen).findings
    assert finding.mistake is Mistake.EXCHANGED
    assert finding.cameras == (cameras[0].name, cameras[1].name)


@pytest.mark.parametrize("rig", RIGS)
@pytest.mark.parametrize("mistake", [Mistake.MIRRORED, Mistake.TURNED, Mistake.ZOOMED])
def test_a_camera_whose_pictures_are_not_as_calibrated_is_named(rig: str, mistake: Mistake) -> None:
    cameras = RIGS[rig]

    def spoiled(one: PersonView) -> PersonView:
        if mistake is Mistake.MIRRORED:
            return mirror_view(one, 640)
        if mistake is Mistake.TURNED:
            return upside_down(one, (640, 480))
        return zoom_view(one, (300.0, 250.0), 1.3)

    seen = [[one[0], [spoiled(one[1][0])], *one[2:]] for one in stretches(cameras)]
    [finding] = judge(cameras, seen).findings
    assert finding.mistake is mistake
    # of a pair, one zoomed in and the other one zoomed out look much alike: both are named
    zoomed_pair = rig == "pair" and mistake is Mistake.ZOOMED
    assert finding.cameras == (("left", "right") if zoomed_pair else (cameras[1].name,))


def test_other_conventions_of_a_rig_are_named() -> None:
    cameras = RIGS["pair"]
    seen = stretches(cameras)
    inverted = [replace(one, R=one.R.T, t_m=centre(one)) for one in cameras]
    [finding] = judge(inverted, seen).findings
    assert finding.mistake is Mistake.INVERTED
    gl = np.diag([1.0, -1.0, -1.0])
    [finding] = judge(
        [replace(one, R=gl @ one.R, t_m=gl @ one.t_m) for one in cameras], seen
    ).findings
    assert finding.mistake is Mistake.AXES
    assert "OpenGL" in finding.what


@pytest.mark.parametrize(
    ("world", "said"),
    [
        ([[1, 0, 0], [0, 0, 1], [0, -1, 0]], r"\+z axis.*\(r_x, r_z, -r_y\)"),
        ([[1, 0, 0], [0, -1, 0], [0, 0, -1]], r"-y axis.*\(r_x, -r_y, -r_z\)"),
        ([[0, -1, 0], [1, 0, 0], [0, 0, 1]], r"\+x axis.*\(-r_y, r_x, r_z\)"),
    ],
)
def test_a_world_that_is_not_y_up_is_named_with_what_mends_it(
    world: list[list[float]], said: str
) -> None:
    cameras = RIGS["pair"]
    turned = [replace(one, R=one.R @ np.array(world, float)) for one in cameras]
    finding = judge_world(("left",), judge(turned, stretches(cameras)).fits, 1.75)
    assert finding is not None
    assert finding.mistake is Mistake.AXES
    assert re.search(said, str(finding))
    columns = re.search(r"\((.*)\)", finding.fix)
    assert columns is not None
    mended = turned[0].R @ np.stack([_column(word) for word in columns[1].split(", ")], axis=1)
    assert np.allclose(mended, cameras[0].R)


def _column(word: str) -> Floats:
    axis = np.eye(3)["xyz".index(word[-1])]
    return np.asarray(-axis if word.startswith("-") else axis)


def test_a_rig_in_feet_is_named() -> None:
    cameras = [replace(one, t_m=one.t_m / 0.3048) for one in RIGS["pair"]]
    finding = judge_world(("left",), judge(cameras, stretches(RIGS["pair"])).fits, None)
    assert finding is not None
    assert finding.mistake is Mistake.UNIT
    assert "feet" in finding.what


def test_views_of_two_rooms_contradict_each_other() -> None:
    cameras = RIGS["pair"]
    other = [
        [
            view(
                looking_at("x", np.array([0.4, 2.4, 1.9]), np.array([0.5, 1.3, 0.3])),
                one[1][0].times_s + 40.0,
                7,
            )
        ]
        for one in stretches(cameras)
    ]
    seen = [
        [one[0], [replace(they[0], times_s=one[0][0].times_s)]]
        for one, they in zip(stretches(cameras), other, strict=True)
    ]
    verdict = judge(cameras, seen)
    assert verdict.findings
    assert verdict.off_m > 0.03


def test_a_zoom_of_an_eighth_shows_in_where_joints_meet_and_none_does_not() -> None:
    cameras = RIGS["pair"]
    seen = stretches(cameras)
    assert not [*scaled_findings(cameras, seen)]
    larger = [[one[0], [zoom_view(one[1][0], (320.0, 240.0), 1.12)]] for one in seen]
    [finding] = scaled_findings(cameras, larger)
    assert finding.mistake is Mistake.ZOOMED
    assert "larger in those of 'right'" in finding.what


def test_views_that_disagree_a_little_contradict_where_nothing_moves_alike() -> None:
    cameras = RIGS["pair"]
    swung = [
        cameras[0],
        looking_at("right", np.array([1.35, 1.4, 2.6]), np.array([0.05, 0.93, 0.0])),
    ]
    assert judge(swung, stretches(cameras), (True, True)).findings == ()
    [finding] = judge(swung, stretches(cameras), (False, False)).findings
    assert finding.mistake is Mistake.CONTRADICTION
    assert "does not move at the same times" in finding.what


def test_who_bends_down_in_one_stretch_is_no_turned_picture() -> None:
    cameras = RIGS["pair"][:1]
    upright = [one[0][0] for one in stretches(cameras)]
    bent = upside_down(upright[0], (640, 480))
    assert not [*turned_views(cameras, [[bent, *upright[1:]]])]
    assert not [*turned_views(cameras, [[bent]])]


def test_people_who_lie_in_one_cameras_pictures_are_told_of() -> None:
    cameras = RIGS["pair"]
    views = [
        [upside_down(one[i][0], (640, 480)) if i else one[i][0] for one in stretches(cameras)]
        for i in range(2)
    ]
    [finding] = turned_views(cameras, views)
    assert finding.cameras == ("right",)
    assert "180 degrees" in finding.what
