"""The network of heatmaps: what goes in and comes out, and whether it finds joints in pictures that it never saw."""

import numpy as np
import pytest

from mocapd.body.skeleton import INDEX
from mocapd.vision.heatmaps.heatmap_kernels import fill_input, read_maps
from mocapd.vision.heatmaps.joint_network import CELLS, INPUT_PX, JOINTS, JointNetwork

pytestmark = pytest.mark.kernels


def test_input_is_the_picture_and_how_far_it_is_off_its_background() -> None:
    rng = np.random.default_rng(1)
    picture = rng.integers(0, 255, (6, 5, 3)).astype(np.uint8)
    background = rng.uniform(0.0, 255.0, (6, 5, 3)).astype(np.float32)
    known = (rng.uniform(size=(6, 5)) < 0.7).astype(np.uint8)
    out = np.empty((4, 6, 5), np.float32)
    fill_input(picture, background, known, out)
    np.testing.assert_allclose(out[:3], picture.transpose(2, 0, 1) / 255.0 - 0.5, atol=1e-6)
    off = np.abs(picture - background).max(axis=2) * (4.0 / 255.0)
    np.testing.assert_allclose(out[3], np.where(known > 0, np.minimum(off, 1.0), 0.0), atol=1e-5)


def test_maps_are_read_by_their_moments() -> None:
    rng = np.random.default_rng(2)
    maps = rng.normal(0.0, 2.0, (6, 7, 8)).astype(np.float32)
    out = np.empty((2, 7))
    read_maps(maps, 2, out)
    y, x = np.mgrid[:7, :8]
    for j in range(2):
        p = np.exp(maps[j].astype(float))
        p /= p.sum()
        mx, my = (p * x).sum(), (p * y).sum()
        spread = [
            (p * (x - mx) ** 2).sum(),
            (p * (x - mx) * (y - my)).sum(),
            (p * (y - my) ** 2).sum(),
        ]
        np.testing.assert_allclose(out[j, :5], [mx, my, *spread], rtol=1e-6)
        assert out[j, 5] == pytest.approx((p * maps[2 + j]).sum())
        assert out[j, 6] == pytest.approx(np.exp(np.clip((p * maps[4 + j]).sum(), -4.0, 1.0)))


def test_maps_know_left_from_right_by_name() -> None:
    for name in JOINTS:
        assert name in INDEX
        if name.startswith("left"):
            assert JOINTS[JOINTS.index(name) + 1] == "right" + name[4:]


def test_nobody_is_seen_in_an_empty_room_with_certainty() -> None:
    grey = np.full((INPUT_PX, INPUT_PX, 3), 120, np.uint8)
    seen = JointNetwork().detect(
        grey, grey.astype(np.float32), np.ones((INPUT_PX, INPUT_PX), np.uint8)
    )
    arms = [
        JOINTS.index(side + bone) for side in ("left", "right") for bone in ("LowerArm", "Hand")
    ]
    assert np.isfinite(seen.at_cells).all()
    assert (seen.spread_cells2[arms][:, [0, 2]].sum(axis=1) > 2.0).all()
    assert ((seen.at_cells >= 0) & (seen.at_cells < CELLS)).all()
