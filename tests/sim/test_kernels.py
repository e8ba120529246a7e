"""Each fast kernel against a slow, obvious twin."""

import cv2
import numpy as np
import pytest

from mocapd.body.shape import mean_shape, skeleton_of
from mocapd.body.skeleton import global_from_local, joint_positions
from mocapd.body.surface import posed_vertices
from mocapd.body.surface_building import build_surface
from mocapd.geometry import rotations
from mocapd.sim.person.dress_kernels import Dress
from mocapd.sim.person.figure import build_figure
from mocapd.sim.person.figure_kernels import light_vertices, skin_vertices, vertex_normals
from mocapd.sim.person.leg_shape import leg_rotations
from mocapd.sim.person_spec import Clothes
from mocapd.sim.render_kernels import accumulate, project_vertices, rasterise
from mocapd.sim.response_kernels import PersonLayer, Sensor, expose
from mocapd.sim.scenery.lamps import lamps_of
from mocapd.sim.scenery.shadows import lamp_views, shadow_maps
from mocapd.sim.world import World
from mocapd.types import Floats, Pose, Skeleton
from tests.sim.small import scenario

RNG = np.random.default_rng(3)


def random_pose(skeleton: Skeleton) -> Pose:
    local = rotations.exp(RNG.normal(scale=0.5, size=(len(skeleton.names), 3)))
    return Pose(RNG.normal(size=3), global_from_local(skeleton, local))


def test_the_leg_reaches_what_is_in_reach_and_its_knee_bends_forwards() -> None:
    thigh, shank = np.array([0.0, -0.42, 0.0]), np.array([0.0, -0.43, 0.0])
    hip, forward = np.array([0.1, 0.93, 0.2]), np.array([0.0, 0.0, 1.0])
    for _ in range(50):
        ankle = hip + RNG.uniform((-0.25, -0.8, -0.25), (0.25, -0.5, 0.25))
        R = leg_rotations(hip, thigh, shank, ankle, forward, 0.2)
        assert np.allclose(R @ np.swapaxes(R, 1, 2), np.eye(3), atol=1e-12)
        assert np.allclose(np.linalg.det(R), 1.0)
        knee = hip + R[0] @ thigh
        assert np.allclose(knee + R[1] @ shank, ankle, atol=1e-9)
        assert (knee - 0.5 * (hip + ankle))[2] > 0.0


def test_skinning_equals_the_body_module_where_nothing_is_folded() -> None:
    shape = mean_shape(1.75)
    skeleton, surface = skeleton_of(shape), build_surface(shape)
    n = len(surface.vertices_m)
    bones = np.tile(np.arange(len(skeleton.names), dtype=np.int32), (n, 1))
    for _ in range(3):
        pose = random_pose(skeleton)
        joints = joint_positions(skeleton, pose)
        R = rotations.to_matrix(pose.quats_xyzw)
        t = joints - np.einsum("jab,jb->ja", R, skeleton.rest_m)
        out = np.empty_like(surface.vertices_m)
        skin_vertices(
            surface.vertices_m, np.zeros((n, 3)), np.zeros(n), np.full(n, -1, dtype=np.int64),
            np.zeros(len(skeleton.names)), bones, surface.weights, R, t, out,
        )  # fmt: skip
        assert np.allclose(out, posed_vertices(surface, skeleton, pose, joints))


def test_the_figure_stays_within_its_folds_of_the_body() -> None:
    clothes = Clothes()
    figure = build_figure(mean_shape(1.75), clothes, seed=1)
    plain = build_figure(mean_shape(1.75), Clothes(wrinkles_m=0.0), seed=1)
    off = np.linalg.norm(figure.vertices_m - plain.vertices_m, axis=1)
    assert 0.5 * clothes.wrinkles_m < off.max() < 3 * clothes.wrinkles_m
    assert np.allclose(figure.weights.sum(axis=1), 1.0)
    assert figure.patch.max() == 20


def test_vertex_normals_equal_the_sum_of_the_faces() -> None:
    figure = build_figure(mean_shape(1.75), Clothes(), seed=1)
    vertices = figure.vertices_m / np.linalg.norm(figure.vertices_m, axis=1, keepdims=True)
    slow = np.zeros_like(vertices)
    for a, b, c in figure.triangles:
        n = np.cross(vertices[b] - vertices[a], vertices[c] - vertices[a])
        slow[[a, b, c]] += n
    fast = np.empty_like(vertices)
    vertex_normals(vertices, figure.triangles, fast)
    size = np.linalg.norm(slow, axis=1, keepdims=True)
    assert np.allclose(fast, slow / np.maximum(size, 1e-12), atol=1e-6)


def test_projection_equals_opencv_and_the_box_holds_all_points() -> None:
    K = np.array([[300.0, 0.0, 80.0], [0.0, 310.0, 60.0], [0.0, 0.0, 1.0]])
    dist = np.array([-0.2, 0.05, 0.001, -0.002, 0.01])
    R = rotations.to_matrix(rotations.exp(np.array([0.1, -0.2, 0.05])))
    t = np.array([0.1, 0.2, 3.0])
    points = RNG.uniform(-0.6, 0.6, (40, 3))
    out = np.empty((40, 3))
    x0, y0, x1, y1 = project_vertices(points, R, t, K, dist, (160, 120), out)
    theirs, _ = cv2.projectPoints(points, R, t, K, dist)
    assert np.allclose(out[:, :2], theirs[:, 0], atol=1e-6)
    inside = out[(out[:, :2] >= 0).all(1) & (out[:, 0] <= 159) & (out[:, 1] <= 119)]
    assert (inside[:, :2] >= (x0, y0)).all()
    assert (inside[:, :2] < (x1, y1)).all()


def _first_hit(corners: Floats, ray: Floats) -> tuple[int, float, Floats]:
    """The front triangle (T,3,3) in camera axes that a ray from 0 meets first: index, depth, weights."""
    a, b, c = corners.swapaxes(0, 1)
    in_front = (np.cross(b - a, c - a) * a).sum(axis=1) < 0.0  # else seen from behind
    share = np.linalg.solve(corners.swapaxes(1, 2), np.tile(ray[:, None], (len(corners), 1, 1)))
    share = share[:, :, 0]
    met = np.flatnonzero(in_front & (share >= 0.0).all(axis=1))
    if not len(met):
        return -1, np.inf, np.zeros(3)
    best = int(met[np.argmax(share[met].sum(axis=1))])
    return best, 1.0 / share[best].sum(), share[best] / share[best].sum()


def test_the_rasteriser_equals_casting_a_ray_through_every_pixel() -> None:
    K = np.array([[40.0, 0.0, 19.5], [0.0, 40.0, 14.5], [0.0, 0.0, 1.0]])
    vertices = np.stack(
        [RNG.uniform(-1, 1, 60), RNG.uniform(-0.8, 0.8, 60), RNG.uniform(1.0, 4.0, 60)], -1
    )
    triangles = RNG.permutation(60).reshape(20, 3).astype(np.int32)
    points = np.empty_like(vertices)
    project_vertices(vertices, np.eye(3), np.zeros(3), K, np.zeros(5), (40, 30), points)
    nearness = np.zeros((30, 40), dtype=np.float32)
    owner = np.full((30, 40), -1, dtype=np.int32)
    weights = np.zeros((30, 40, 2), dtype=np.float32)
    rasterise(points, triangles, 0.0, 0.0, nearness, owner, weights)
    wrong = 0
    for y in range(30):
        for x in range(40):
            ray = np.linalg.solve(K, np.array([x, y, 1.0]))
            k, depth, share = _first_hit(vertices[triangles], ray)
            if k != owner[y, x]:
                wrong += 1  # rounding may give a pixel on an edge to either side
            elif k >= 0:
                assert 1.0 / nearness[y, x] == pytest.approx(depth, rel=1e-4)
                assert np.allclose(weights[y, x], share[1:], atol=1e-3)
    assert (owner >= 0).sum() > 100
    assert wrong <= 2


def test_accumulate_shades_by_corner_weights_and_cleans_up() -> None:
    triangles = np.array([[0, 1, 2]], dtype=np.int32)
    albedo, irradiance = np.array([[0.5, 0.4, 0.2]]), np.array([[1.0] * 3, [2.0] * 3, [4.0] * 3])
    nearness, owner = np.zeros((2, 2), np.float32), np.full((2, 2), -1, np.int32)
    weights = np.zeros((2, 2, 2), np.float32)
    nearness[1, 0], owner[1, 0], weights[1, 0] = 0.5, 0, (0.25, 0.5)
    colour, cover = np.zeros((2, 2, 3), np.float32), np.zeros((2, 2), np.float32)
    nothing = np.zeros(1, dtype=np.uint8)
    dress = Dress(np.zeros((3, 3)), nothing, nothing, np.zeros(1, np.int32), np.zeros((1, 46)))
    accumulate(
        triangles, albedo, irradiance.astype(np.float32), nearness, owner, weights, (0, 0, 2, 2),
        0.5, dress, np.zeros(1), colour, cover,
    )  # fmt: skip
    light = 0.25 * 1.0 + 0.25 * 2.0 + 0.5 * 4.0
    assert np.allclose(colour[1, 0], 0.5 * light * albedo[0])
    assert cover.sum() == 0.5
    assert (owner == -1).all()
    assert not nearness.any()


def test_light_falls_with_the_square_of_distance_and_not_into_shadow() -> None:
    s = scenario()
    lamps, world = lamps_of(s), World(s)
    figure = build_figure(world.shape, s.clothes, s.seed)
    middle = figure.vertices_m.mean(axis=0)
    views = lamp_views(lamps, middle)
    depths = shadow_maps(figure.vertices_m, figure.triangles, views, np.ones(2))
    lit = np.empty((2, 3), dtype=np.float32)
    lamp = lamps.at_m[0]
    towards = (lamp - middle) / np.linalg.norm(lamp - middle)
    rgb = lamps.rgb * np.array([[1.0], [0.0]])
    # before the person, and at 3 m from the lamp right behind her
    places = np.stack([lamp - 0.5 * towards, lamp - 3.6 * towards])
    light_vertices(
        places, np.stack([towards] * 2), lamps.at_m, rgb, lamps.sun, np.zeros(3), np.zeros(3),
        views, depths, lit,
    )  # fmt: skip
    assert np.allclose(lit[0], rgb[0] / 0.25, rtol=1e-4)
    assert not lit[1].any()


def test_exposure_equals_its_formula_without_noise() -> None:
    h, w = 6, 8
    room = RNG.uniform(0, 1, (h, w, 3)).astype(np.float32)
    layers = RNG.uniform(0, 0.2, (2, h, w, 3)).astype(np.float32)
    shade = RNG.uniform(0, 1, (1, h, w)).astype(np.float32)
    colour, cover = np.zeros((h, w, 3), np.float32), np.zeros((h, w), np.float32)
    colour[2:4, 3:5], cover[2:4, 3:5] = 0.3, 0.75
    gains = np.array([1.1, 1.0, 0.9], dtype=np.float32)
    curve = np.round(255 * np.linspace(0, 2, 1 << 12).clip(0, 1)).astype(np.uint8)
    out = np.empty((h, w, 3), dtype=np.uint8)
    expose(
        room, layers, np.ones(1, np.float32), shade, PersonLayer(colour, cover, (3, 2, 5, 4)),
        Sensor(gains, 0.2, 0.0, 0.0, np.zeros(64, np.float32), curve), 9, out,
    )  # fmt: skip
    y, x = np.mgrid[:h, :w]
    r2 = ((x - w / 2) ** 2 + (y - h / 2) ** 2) / (0.25 * (w * w + h * h))
    light = (room - shade[0][..., None] * layers[1]) * (1 - cover[..., None]) + colour
    slow = 255 * np.clip(light * gains * (1 - 0.2 * r2)[..., None], 0, 1)
    assert np.abs(out[..., ::-1] - slow).max() <= 1.0
