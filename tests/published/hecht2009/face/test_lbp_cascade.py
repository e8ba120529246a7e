"""The cascade: its file, its features against a naive twin, and what it finds in pictures."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from mocapd.published.hecht2009.face.face_detection import (
    face_sizes,
    face_windows,
    faces_near,
    group_windows,
)
from mocapd.published.hecht2009.face.lbp_cascade import frontal_faces, read_cascade
from mocapd.published.hecht2009.face.lbp_cascade_kernels import (
    WINDOW_PX,
    CascadeArrays,
    lbp_code,
    scan,
)
from mocapd.types import Bytes
from tests.published.hecht2009.face.toy_face import write_cascade


@pytest.fixture(scope="module")
def toy(tmp_path_factory: pytest.TempPathFactory) -> CascadeArrays:
    return read_cascade(write_cascade(tmp_path_factory.mktemp("toy") / "face.xml"))


def picture_with(x: float, y: float, size: float) -> Bytes:
    """A bright square, a third of `size` wide, in a darker room with light from one side."""
    room = np.tile(np.linspace(40, 90, 200), (150, 1))
    half = size / 6.0
    v, u = np.mgrid[:150, :200]
    inside = (abs(u - x) < half) & (abs(v - y) < half)
    return np.asarray(np.where(inside, 200, room), np.uint8)


def integral_of(grey: Bytes) -> NDArray[np.int32]:
    return np.asarray(cv2.integral(grey), np.int32)


def naive_code(grey: Bytes, y: int, x: int, h: int, w: int) -> int:
    blocks = [
        [
            int(grey[y + j * h : y + (j + 1) * h, x + i * w : x + (i + 1) * w].sum())
            for i in range(3)
        ]
        for j in range(3)
    ]
    code = 0
    for j, i in ((0, 0), (0, 1), (0, 2), (1, 2), (2, 2), (2, 1), (2, 0), (1, 0)):
        code = 2 * code + int(blocks[j][i] >= blocks[1][1])
    return code


@given(seed=st.integers(0, 2**32 - 1), h=st.integers(1, 5), w=st.integers(1, 5))
@settings(max_examples=40, deadline=None)
def test_the_code_of_a_feature_is_that_of_its_blocks(seed: int, h: int, w: int) -> None:
    rng = np.random.default_rng(seed)
    grey = rng.integers(0, 4, (30, 32), dtype=np.uint8)
    y, x = int(rng.integers(0, 30 - 3 * h + 1)), int(rng.integers(0, 32 - 3 * w + 1))
    assert lbp_code(integral_of(grey), y, x, h, w) == naive_code(grey, y, x, h, w)


def test_a_scan_in_steps_finds_what_the_windows_beside_a_promising_one_hold(
    toy: CascadeArrays,
) -> None:
    integral = integral_of(picture_with(71.5, 60.5, 24.0))
    out = np.empty((500, 2), np.int64)
    every = {tuple(row) for row in out[: scan(toy, integral, 1, 3, out)].tolist()}
    steps = {tuple(row) for row in out[: scan(toy, integral, 2, 1, out)].tolist()}
    assert every
    assert steps <= every
    assert {(x, y) for x, y in every if x % 2 == 0 and y % 2 == 0} <= steps


@pytest.mark.parametrize(("x", "y", "size"), [(60.0, 50.0, 24.0), (130.0, 90.0, 48.0), (99.0, 70.0, 72.0)])  # fmt: skip
def test_a_face_is_found_where_it_is(toy: CascadeArrays, x: float, y: float, size: float) -> None:
    windows = face_windows(toy, picture_with(x, y, size), face_sizes(20.0, 110.0))
    (box, *others) = group_windows(windows, 2)
    assert not others
    assert np.hypot(box.x_px - x, box.y_px - y) < 0.1 * size
    assert 0.75 < box.size_px / size < 1.25


def test_a_region_is_all_that_is_looked_at(toy: CascadeArrays) -> None:
    grey = picture_with(60.0, 50.0, 30.0)
    inside = face_windows(toy, grey, (30.0,), (30, 20, 90, 80))
    assert len(inside)
    assert len(face_windows(toy, grey, (30.0,), (90, 60, 200, 150))) == 0
    assert len(face_windows(toy, grey, (30.0,), (55, 45, 65, 55))) == 0  # less than a window


def test_a_face_near_a_place_is_found_and_one_elsewhere_is_not(toy: CascadeArrays) -> None:
    grey = picture_with(60.0, 50.0, 30.0)
    assert faces_near(toy, grey, 64.0, 48.0, 30.0, 10.0, 2)
    assert not faces_near(toy, grey, 140.0, 90.0, 30.0, 10.0, 2)


def test_windows_of_two_faces_stay_two_groups() -> None:
    one = [[10.0, 10.0, 24.0], [11.0, 10.0, 26.0], [12.0, 9.0, 24.0]]
    other = [[60.0, 10.0, 24.0], [61.0, 10.0, 24.0]]
    windows = np.array(one + other)
    first, second = group_windows(windows, 2)
    for box, of in ((first, one), (second, other)):
        assert (box.x_px, box.y_px, box.size_px) == pytest.approx(tuple(np.mean(of, axis=0)))
    assert group_windows(windows, 3) == (first,)


@given(least=st.floats(5.0, 100.0), ratio=st.floats(0.5, 20.0))
def test_sizes_go_from_the_least_to_the_largest_in_equal_steps(least: float, ratio: float) -> None:
    sizes = face_sizes(least, least * ratio)
    if ratio < 1.0:
        assert sizes == ()
    else:
        assert sizes[0] == pytest.approx(least)
        assert sizes[-1] <= least * ratio * 1.001 < sizes[-1] * 1.2 * 1.002
        assert np.allclose(np.diff(np.log(sizes)), np.log(1.2))


def test_a_file_without_lbp_features_is_refused(tmp_path: Path) -> None:
    other = tmp_path / "haar.xml"
    other.write_text("<opencv_storage><cascade><featureType>HAAR</featureType></cascade></opencv_storage>")  # fmt: skip
    with pytest.raises(ValueError, match="LBP"):
        read_cascade(other)


def test_the_packaged_cascade_sees_no_face_in_noise_and_has_the_window_it_is_slid_with() -> None:
    cascade = frontal_faces()
    assert len(cascade.threshold) == 20
    assert (cascade.rects[:, :2] + 3 * cascade.rects[:, 2:] <= WINDOW_PX).all()
    noise = np.random.default_rng(0).integers(0, 256, (240, 320), dtype=np.uint8)
    assert not group_windows(face_windows(cascade, noise, face_sizes(24.0, 100.0)), 3)
