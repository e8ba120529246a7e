"""The surface: closed, outward, symmetric, linear in the shape, patched as the shirt's standard says."""

import json

import numpy as np
import pytest
import scipy  # its submodules load on first use: they take long to import

from mocapd.assets import asset_path
from mocapd.body.shape import N_FACTORS, BodyShape, mean_shape, skeleton_of
from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.body.surface import (
    HEAD,
    LEFT_ARM,
    LEFT_LEG,
    RIGHT_ARM,
    RIGHT_LEG,
    SKIN,
    TOP,
    TORSO,
)
from mocapd.body.surface_building import (
    build_surface,
    build_whole_surface,
    shape_derivatives,
)
from mocapd.shirt.standard_shirt import N_PATCHES, standard_shirt
from mocapd.types import Floats, Ints

STATURE_M = 1.72
ODD = BodyShape(STATURE_M, np.array([1.04, 0.93, 1.03, 0.95, 1.12, 0.9, 1.15]))
SHAPES = [mean_shape(STATURE_M), ODD]
FRACTIONS = json.loads(asset_path("shirt_standard_v1.json").read_text())["arm_fractions"]
BASE = {"left": 9, "right": 15}  # the shoulder's patch; the others follow in the file's order


def tubes(shape: BodyShape) -> list[tuple[Floats, Ints]]:
    """Vertices and triangles of each connected piece."""
    surface = build_surface(shape)
    T = surface.triangles
    ends = (T.ravel(), T[:, [1, 2, 0]].ravel())
    n = len(surface.vertices_m)
    joined = scipy.sparse.coo_array((np.ones(T.size), ends), shape=(n, n))
    count, piece = scipy.sparse.csgraph.connected_components(joined)
    assert count == 6  # torso, arms, head, legs
    return [(surface.vertices_m, T[piece[T[:, 0]] == i]) for i in range(count)]


def winding_number(points_m: Floats, corners_m: Floats) -> Floats:
    """(P,): how often the surface (T,3,3) goes around each point (van Oosterom and Strackee 1983)."""
    a, b, c = np.moveaxis(corners_m[None] - points_m[:, None, None], 2, 0)
    la, lb, lc = (np.linalg.norm(v, axis=-1) for v in (a, b, c))
    dot = [np.vecdot(u, v) for u, v in ((a, b), (b, c), (c, a))]
    solid = np.vecdot(a, np.cross(b, c))
    angle = np.arctan2(solid, la * lb * lc + dot[0] * lc + dot[1] * la + dot[2] * lb)
    out: Floats = angle.sum(axis=1) / (2.0 * np.pi)
    return out


@pytest.mark.parametrize("shape", SHAPES)
def test_every_piece_is_closed(shape: BodyShape) -> None:
    for _, triangles in tubes(shape):
        edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        there, times = np.unique(edges, axis=0, return_counts=True)
        # each edge once, and once in the other direction by the neighbour
        assert (times == 1).all()
        back = np.unique(edges[:, ::-1], axis=0)
        np.testing.assert_array_equal(there, back)


@pytest.mark.parametrize("shape", SHAPES)
def test_normals_point_outwards(shape: BodyShape) -> None:
    for vertices, triangles in tubes(shape):
        corners = vertices[triangles]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        middle = corners.mean(axis=1)
        np.testing.assert_allclose(winding_number(middle - 5e-4 * normal, corners), 1.0, atol=1e-6)
        np.testing.assert_allclose(winding_number(middle + 5e-4 * normal, corners), 0.0, atol=1e-6)


@pytest.mark.parametrize("shape", SHAPES)
def test_torso_patches_are_where_the_standard_says(shape: BodyShape) -> None:
    surface, rest = build_surface(shape), skeleton_of(shape).rest_m
    hips, neck = rest[INDEX["hips"]], rest[INDEX["neck"]]
    torso = surface.part == TORSO
    x, y, z = surface.vertices_m[surface.triangles[torso]].mean(axis=1).T
    up = (y - hips[1]) / (neck[1] - hips[1])
    back = z < hips[2] + up * (neck[2] - hips[2])
    wanted = 1 + (x < 0) + 2 * (up < 0.5) + 4 * back
    np.testing.assert_array_equal(surface.area[torso], np.where(up > 0, wanted, 0))


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize("side", ["left", "right"])
def test_arm_patches_are_where_the_standard_says(shape: BodyShape, side: str) -> None:
    surface, rest = build_surface(shape), skeleton_of(shape).rest_m
    arm, elbow, wrist = (rest[INDEX[side + bone]] for bone in ("UpperArm", "LowerArm", "Hand"))
    mine = surface.part == (LEFT_ARM if side == "left" else RIGHT_ARM)
    middle = surface.vertices_m[surface.triangles[mine]].mean(axis=1)
    patch, material = surface.area[mine], surface.material[mine]

    def along(start: Floats, end: Floats) -> tuple[Floats, Floats]:
        """Fraction of the bone, and how far in front of it."""
        bone = end - start
        t = (middle - start) @ bone / (bone @ bone)
        return t, middle[:, 2] - (start + t[:, None] * bone)[:, 2]

    upper, upper_front = along(arm, elbow)
    fore, fore_front = along(elbow, wrist)
    base = BASE[side]
    spans = [
        (upper, "shoulder", np.full(len(patch), base)),
        (upper, "upper_arm", np.where(upper_front > 0, base + 1, base + 2)),
        (fore, "forearm", np.where(fore_front > 0, base + 3, base + 4)),
        (fore, "cuff", np.full(len(patch), base + 5)),
    ]
    for t, name, wanted in spans:
        low, high = FRACTIONS[name]
        inside = (t > low) & (t < high)
        assert inside.sum() >= 12
        np.testing.assert_array_equal(patch[inside], wanted[inside])
        assert (material[inside] == TOP).all()
    trunk = upper < 0.0  # on this side of the shoulder joint's plane
    assert trunk.sum() >= 24
    of_trunk = np.where(upper_front > 0, 1, 5) + (side == "right")
    np.testing.assert_array_equal(patch[trunk], of_trunk[trunk])
    hand = fore > FRACTIONS["cuff"][1]
    assert (patch[hand] == 0).all()
    assert (material[hand] == SKIN).all()


def test_every_patch_is_there_and_only_on_the_shirt() -> None:
    surface = build_surface(mean_shape(STATURE_M))
    assert set(surface.area) == set(range(N_PATCHES + 1))
    assert (surface.material[surface.area > 0] == TOP).all()


def test_neighbouring_patches_differ_in_colour() -> None:
    surface, colour = build_surface(mean_shape(STATURE_M)), standard_shirt().colour_of_patch
    patches_at: dict[int, set[int]] = {}
    for triangle, patch in zip(surface.triangles, surface.area, strict=True):
        for vertex in triangle:
            patches_at.setdefault(int(vertex), set()).add(int(patch))
    for patches in patches_at.values():
        colours = [int(colour[p]) for p in patches if p > 0]
        assert len(colours) == len(set(colours))


def other_side(patch: Ints) -> Ints:
    """The patch on the other side of the body."""
    names = ("", *standard_shirt().patch_names)
    swapped = [
        name.replace("left", "#").replace("right", "left").replace("#", "right") for name in names
    ]
    return np.array([names.index(name) for name in swapped])[patch]


@pytest.mark.parametrize("shape", SHAPES)
def test_left_and_right_mirror_each_other(shape: BodyShape) -> None:
    surface = build_surface(shape)
    mirrored = surface.vertices_m * np.array([-1.0, 1.0, 1.0])
    apart = np.abs(mirrored[:, None] - surface.vertices_m[None]).max(axis=2)
    twin = apart.argmin(axis=1)
    assert apart.min(axis=1).max() < 1e-9
    swap = np.arange(N_JOINTS)
    for name, j in INDEX.items():
        for a, b in (("left", "right"), ("right", "left")):
            if name.startswith(a):
                swap[j] = INDEX[name.replace(a, b)]
    # the middle of each cap moves with one point of its rim; the torso's upper one is inside the neck
    rims = np.flatnonzero(np.abs(surface.vertices_m[:, 0]) > 1e-9)
    np.testing.assert_allclose(
        surface.weights[twin][:, swap][rims], surface.weights[rims], atol=1e-9
    )
    for patch in range(1, N_PATCHES + 1):
        here = np.unique(surface.triangles[surface.area == patch])
        there = np.unique(surface.triangles[surface.area == other_side(np.array(patch))])
        assert set(twin[here]) == set(there)


def test_skin_weights_are_shares() -> None:
    weights = build_surface(ODD).weights
    assert (weights >= 0.0).all()
    np.testing.assert_allclose(weights.sum(axis=1), 1.0, atol=1e-12)
    assert (weights > 0).sum(axis=1).max() <= 4  # what body.model keeps of them


def test_the_surface_is_linear_in_the_shape_factors() -> None:
    d_vertices, d_rest = shape_derivatives(STATURE_M)
    assert len(d_vertices) == len(d_rest) == N_FACTORS
    mean = build_surface(mean_shape(STATURE_M)).vertices_m
    offset = ODD.factors - 1.0
    predicted = mean + np.tensordot(offset, d_vertices, axes=1)
    rebuilt = build_surface(ODD).vertices_m
    # products such as torso length times girth have no part in it, so nothing is left over
    np.testing.assert_allclose(predicted, rebuilt, atol=1e-9)
    joints = skeleton_of(mean_shape(STATURE_M)).rest_m + np.tensordot(offset, d_rest, axes=1)
    np.testing.assert_allclose(joints, skeleton_of(ODD).rest_m, atol=1e-12)


def test_the_surface_grows_with_stature() -> None:
    small, tall = (
        build_surface(mean_shape(1.5)).vertices_m,
        build_surface(mean_shape(1.8)).vertices_m,
    )
    np.testing.assert_allclose(tall, 1.2 * small, atol=1e-9)


def test_flesh_lies_about_the_joints_as_people_have_it() -> None:
    """Belly, chest and head lie in front of the line of the joints; thighs in front of hip-knee, calves behind knee-ankle.
    Drawn about the joints' line, hips and head were found 2 to 3 cm in front of where they turn."""
    shape = mean_shape(1.0)
    surface, rest = build_whole_surface(shape), skeleton_of(shape).rest_m

    def ahead(part: int, start: str, end: str, along: float) -> float:
        """Of the middle of the flesh about a point of a bone [statures]."""
        a, b = rest[INDEX[start]], rest[INDEX[end]]
        at = a + along * (b - a)
        corners = surface.vertices_m[surface.triangles[surface.part == part]].reshape(-1, 3)
        z = corners[np.abs(corners[:, 1] - at[1]) < 0.015, 2]
        return float(0.5 * (z.min() + z.max()) - at[2])

    assert 0.015 < ahead(TORSO, "hips", "neck", 0.35) < 0.03
    assert 0.010 < ahead(HEAD, "neck", "head", 1.0) < 0.03
    for side, part in (("left", LEFT_LEG), ("right", RIGHT_LEG)):
        assert 0.005 < ahead(part, side + "UpperLeg", side + "LowerLeg", 0.4) < 0.02
        assert -0.02 < ahead(part, side + "LowerLeg", side + "Foot", 0.3) < -0.005
