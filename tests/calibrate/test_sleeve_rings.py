"""A sleeve drawn as a cylinder gives its ring's middle; rings of arms put a camera back in its place."""

from dataclasses import replace

import numpy as np

from mocapd.body.skeleton import INDEX, standard_skeleton
from mocapd.calibrate.self_calibration.body_rows import move_camera
from mocapd.calibrate.self_calibration.patch_tracks import PatchSighting
from mocapd.calibrate.self_calibration.ring_bundle import lengths_m, place_by_rings
from mocapd.calibrate.self_calibration.ring_pairs import RingPairs
from mocapd.calibrate.self_calibration.sleeve_rings import N_ALONG, sleeve_rings
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import centre, normalised, project, to_camera
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Floats
from tests.geometry.rigs import looking_at

STATURE_M = 1.75
CAMERAS = tuple(
    looking_at(name, np.array(eye_m), np.array([0.0, 1.1, 0.0]), roll_rad=0.02)
    for name, eye_m in (("left", (-1.4, 1.4, 2.3)), ("right", (1.5, 1.3, 2.2)))
)
FACTOR = 2
RADIUS_M = 0.04
FORE_RING = N_ALONG - 2  # of the left arm


def joints(turn: Floats, shift_m: Floats) -> Floats:
    """A T-pose body (J,3) [m], turned and moved."""
    rest = standard_skeleton(STATURE_M).rest_m
    out: Floats = (rest - rest[0]) @ rotations.to_matrix(rotations.exp(turn)).T + rest[0] + shift_m
    return out


def seen_forearm(camera_index: int, body: Floats) -> PatchSighting:
    """The left forearm as a cylinder: forearm's colour, then the cuff's; nothing else."""
    camera, shirt = CAMERAS[camera_index], standard_shirt()
    elbow, wrist = body[INDEX["leftLowerArm"]], body[INDEX["leftHand"]]
    along = wrist - elbow
    side = np.cross(along, [0.0, 1.0, 0.0])
    side /= np.linalg.norm(side)
    up = np.cross(side, along) / np.linalg.norm(along)
    t, angle = (g.ravel() for g in np.meshgrid(np.linspace(0, 0.95, 400), np.linspace(0, 6.3, 400)))
    out = np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * up
    surface = elbow + t[:, None] * along + RADIUS_M * out
    front = ((centre(camera) - surface) * out).sum(axis=1) > 0.0
    px = project(camera, surface[front])
    at = np.rint((px - (FACTOR - 1) / 2) / FACTOR).astype(int)
    w, h = (side_px // FACTOR for side_px in camera.size_px)
    inside = (at >= 0).all(axis=1) & (at[:, 0] < w) & (at[:, 1] < h)
    ids = np.zeros((h, w), np.uint8)
    patch = np.where(
        t[front] < 0.55,
        shirt.patch_names.index("left_forearm_front") + 1,
        shirt.patch_names.index("left_cuff") + 1,
    )
    ids[at[inside, 1], at[inside, 0]] = shirt.colour_of_patch[patch[inside]]
    mine = to_camera(camera, body)
    quats = np.tile(rotations.IDENTITY_XYZW, (len(mine), 1))
    return PatchSighting(0, mine, quats, np.ones(len(mine)), ids, (0, 0, w * FACTOR, h * FACTOR))


def test_the_middle_of_a_ring_is_where_the_arms_axis_is_from_both_sides() -> None:
    off_px = []
    for yaw in (0.0, 0.1, 0.2):
        body = joints(np.array([0.0, yaw, 0.3]), np.array([-0.6, 0.0, 0.0]))
        elbow, wrist = body[INDEX["leftLowerArm"]], body[INDEX["leftHand"]]
        true = elbow + 0.55 * (wrist - elbow)
        for i, camera in enumerate(CAMERAS):
            sighting = seen_forearm(i, body)
            xy, half_m = sleeve_rings(sighting, sighting.joints_m, camera, FACTOR)
            wanted = normalised(camera, project(camera, true[None]))[0]
            off_px.append(np.linalg.norm(xy[FORE_RING] - wanted) * camera.K[0, 0])
            assert abs(half_m[FORE_RING] - RADIUS_M) < 0.009  # a work px
    assert np.max(off_px) < 1.6  # 0.8 work px: 5 mm


def test_a_ring_that_is_not_in_the_picture_is_not_told() -> None:
    body = joints(np.zeros(3), np.zeros(3))
    sighting = seen_forearm(0, body)
    empty = replace(sighting, ids=np.zeros_like(sighting.ids))
    xy, half_m = sleeve_rings(empty, empty.joints_m, CAMERAS[0], FACTOR)
    assert np.isnan(xy).all()
    assert np.isnan(half_m).all()


def arms(n: int, noise: float) -> RingPairs:
    """n arms of the mean lengths, here and there before both cameras."""
    rng = np.random.default_rng(1)
    ways = rng.normal(size=(n, N_ALONG - 1, 3))
    ways /= np.linalg.norm(ways, axis=-1, keepdims=True)
    ways *= lengths_m(STATURE_M)[:, None]
    first = np.array([0.0, 1.2, 0.0]) + rng.uniform(-0.4, 0.4, (n, 1, 3))
    points = np.concatenate([first, first + np.cumsum(ways, axis=1)], axis=1)
    xy = []
    for camera in CAMERAS:
        at = to_camera(camera, points.reshape(-1, 3)).reshape(points.shape)
        xy.append(at[..., :2] / at[..., 2:] + rng.normal(0.0, noise, (n, N_ALONG, 2)))
    seen = rng.uniform(size=(n, N_ALONG)) < 0.8
    seen[:, 0] = True
    return RingPairs(np.where(seen[..., None], np.stack(xy), 0.0), seen)


def test_rings_put_a_camera_back_in_its_place() -> None:
    true = CAMERAS[1]
    wrong = move_camera(true, np.array([0.1, -0.05, 0.08, 0.02, -0.08, 0.03]))
    loose = np.diag(np.repeat([0.3**2, 0.2**2], 3))
    pairs = arms(120, noise=2e-4)
    gross = pairs.xy.copy()
    gross[1, :6, 1] += 0.15  # rings of something else
    found, covariance = place_by_rings(
        RingPairs(gross, pairs.visible), CAMERAS[0], wrong, loose, STATURE_M
    )
    turn = rotations.angle_rad(rotations.from_matrix(found.R), rotations.from_matrix(true.R))
    assert np.degrees(turn) < 0.5
    assert np.linalg.norm(centre(found) - centre(true)) < 0.04
    assert (np.diag(covariance) < np.diag(loose)).all()


def test_what_is_known_for_certain_stays() -> None:
    wrong = move_camera(CAMERAS[1], np.array([0.1, 0.0, 0.0, 0.0, 0.05, 0.0]))
    found, _ = place_by_rings(arms(40, 1e-3), CAMERAS[0], wrong, 1e-12 * np.eye(6), STATURE_M)
    assert np.allclose(found.R, wrong.R, atol=1e-4)
    assert np.allclose(found.t_m, wrong.t_m, atol=1e-4)
