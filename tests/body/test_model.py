"""The flat body model is the surface without its legs."""

import numpy as np

from mocapd.body.model import build_model, shape_of, shaped
from mocapd.body.shape import mean_shape, skeleton_of
from mocapd.body.skeleton import INDEX
from mocapd.body.surface import LEGS
from mocapd.body.surface_building import build_surface

STATURE_M = 1.66
MODEL = build_model(STATURE_M)
FACTORS = np.array([0.97, 1.05, 0.98, 1.06, 0.9, 1.1, 0.85])


def test_it_holds_the_surface_without_the_legs() -> None:
    surface = build_surface(mean_shape(STATURE_M))
    keep = surface.part != LEGS
    np.testing.assert_array_equal(
        MODEL.vertices_m[MODEL.triangles], surface.vertices_m[surface.triangles[keep]]
    )
    np.testing.assert_array_equal(MODEL.area, surface.area[keep])
    assert len(np.unique(MODEL.triangles)) == len(MODEL.vertices_m)


def test_kept_skin_weights_are_all_the_weights() -> None:
    surface = build_surface(mean_shape(STATURE_M))
    used = np.unique(surface.triangles[surface.part != LEGS])
    dense = np.zeros_like(surface.weights[used])
    np.put_along_axis(dense, MODEL.bones.astype(int), MODEL.weights, axis=1)
    np.testing.assert_allclose(dense, surface.weights[used], atol=1e-12)


def test_a_shaped_body_is_the_body_built_of_that_shape() -> None:
    shape = shape_of(MODEL, FACTORS)
    surface = build_surface(shape)
    vertices, rest = shaped(MODEL, FACTORS)
    used = np.unique(surface.triangles[surface.part != LEGS])
    np.testing.assert_allclose(vertices, surface.vertices_m[used], atol=1e-9)
    np.testing.assert_allclose(rest, skeleton_of(shape).rest_m, atol=1e-9)
    np.testing.assert_array_equal(shaped(MODEL, np.ones(MODEL.n_shape))[0], MODEL.vertices_m)


def test_every_moving_joint_belongs_to_one_group() -> None:
    for g, names in enumerate(MODEL.space.groups):
        assert MODEL.joint_of_group[g] == INDEX[names[0]]
        joints = [INDEX[name] for name in names]
        assert (MODEL.group_of_joint[joints] == g).all()
        np.testing.assert_allclose(MODEL.share_of_joint[joints].sum(), 1.0)
    named = {name for names in MODEL.space.groups for name in names}
    still = [INDEX[name] for name in INDEX if name not in named]
    assert (MODEL.group_of_joint[still] == -1).all()
