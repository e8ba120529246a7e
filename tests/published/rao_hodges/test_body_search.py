"""A whole body in points: found where it stands, facing as it does, and followed."""

import numpy as np

from mocapd.body.shape import mean_shape
from mocapd.geometry import rotations
from mocapd.published.rao_hodges.body_chains import BodyPlace, body_chains
from mocapd.published.rao_hodges.body_search import (
    follow_body,
    match_body,
    start_body,
    upright_place,
)
from mocapd.published.rao_hodges.limb_weight import pose_limb
from mocapd.published.rao_hodges.params import Params
from mocapd.published.rao_hodges.point_cloud import PointCloud, point_cloud
from mocapd.types import Floats

STATURE_M = 1.75
BODY = body_chains(mean_shape(STATURE_M))
AT_M = np.array([0.6, 0.0, -0.4])
COUNT = 3000


def standing(yaw_rad: float) -> BodyPlace:
    """Arms a little out, on straight legs."""
    angles = np.zeros(BODY.whole.n_dof)
    angles[BODY.parts["left_arm"]] = (0.0, 0.0, -0.9, 0.2)
    angles[BODY.parts["right_arm"]] = (0.0, 0.0, 0.9, 0.2)
    turn = rotations.to_matrix(rotations.exp(np.array([0.0, yaw_rad, 0.0])))
    return BodyPlace(AT_M + [0.0, BODY.hips_height_m, 0.0], turn, angles)


def points_of(place: BodyPlace) -> Floats:
    """(P,3): even points of all ellipsoids."""
    rng = np.random.default_rng(4)
    pose, a = pose_limb(BODY.whole, place.angles, place.root_turn, place.root_m), BODY.whole.arrays
    volume = a.radii_m.prod(axis=1)
    which = rng.choice(len(volume), COUNT, p=volume / volume.sum())
    way = rng.standard_normal((COUNT, 3))
    way *= np.cbrt(rng.random(COUNT))[:, None] / np.linalg.norm(way, axis=1, keepdims=True)
    local = a.centres_m[which] + a.radii_m[which] * way
    points: Floats = np.einsum("pij,pj->pi", pose.R[0, which], local) + pose.joints_m[0, which]
    return points


def cloud_of(place: BodyPlace) -> PointCloud:
    volume_m3 = 4.0 / 3.0 * np.pi * BODY.whole.arrays.radii_m.prod(axis=1).sum()
    return point_cloud(points_of(place), COUNT / volume_m3)


def test_somebody_who_stands_is_found_and_an_empty_or_low_hull_is_nobody() -> None:
    points = points_of(standing(0.5))
    found = upright_place(points, STATURE_M)
    assert found is not None
    assert np.linalg.norm(found - AT_M) < 0.1
    assert upright_place(points[:20], STATURE_M) is None
    assert upright_place(np.empty((0, 3)), STATURE_M) is None
    assert upright_place(points * [1.0, 0.5, 1.0], STATURE_M) is None  # a table


def test_the_start_faces_as_the_person_does() -> None:
    for yaw in (0.3, 2.6):
        true = standing(yaw)
        found = start_body(BODY, AT_M, cloud_of(true), np.random.default_rng(0), Params())
        assert found.root_turn[:, 2] @ true.root_turn[:, 2] > 0.9
        assert np.linalg.norm(found.root_m - true.root_m) < 0.06


def test_a_body_that_moves_is_followed_and_explains_its_points() -> None:
    place = standing(0.0)
    rng, true, found = np.random.default_rng(0), place, place
    for k in range(1, 9):
        angles = place.angles.copy()
        angles[2] -= 0.05 * k  # the left thigh forwards
        angles[3] += 0.06 * k
        true = BodyPlace(place.root_m + [0.0, 0.0, 0.01 * k], place.root_turn, angles)
        found, spread = follow_body(
            BODY, found, cloud_of(true), 1.0 / 30.0, rng, Params(converse=1.0)
        )
    match = match_body(BODY, found, cloud_of(true))
    assert match.inside[0] > 0.75
    assert match.full.min() > 0.2
    assert np.linalg.norm(found.root_m - true.root_m) < 0.06
    assert (spread > 0.0).all()
