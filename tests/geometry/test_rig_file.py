"""Rig files: what is written comes back, and every kind of damage is named with its place."""

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mocapd.errors import ConfigError, InputError, MocapdError
from mocapd.geometry.rig_file import camera_from_dict, camera_to_dict, load_rig
from tests.geometry.rigs import ring

ENTRIES = [camera_to_dict(camera) for camera in ring(2)]
FIELDS = ["name", "size", "K", "dist", "R", "t"]


def write(path: Path, data: Any) -> Path:
    path.write_text(json.dumps(data), encoding="utf-8")
    return path


def damaged(field: str, value: Any) -> dict[str, Any]:
    entries = copy.deepcopy(ENTRIES)
    entries[1][field] = value
    return {"cameras": entries}


def test_what_is_written_comes_back_to_the_last_digit(tmp_path: Path) -> None:
    rig = load_rig(write(tmp_path / "rig.json", {"cameras": ENTRIES}))
    assert rig.names == ("cam0", "cam1")
    for got, expected in zip(rig.cameras, ring(2), strict=True):
        assert got.size_px == expected.size_px
        for field in ("K", "dist", "R", "t_m"):
            assert np.array_equal(getattr(got, field), getattr(expected, field))


def test_the_captures_rigs_can_be_read(dev_captures: Callable[[str], Path]) -> None:
    rig = load_rig(dev_captures("pair_office_traffic") / "rig.json")
    assert len(rig.cameras) == 2
    assert rig.cameras[0].size_px == (640, 480)


@pytest.mark.parametrize("field", FIELDS)
def test_a_missing_field_is_named(tmp_path: Path, field: str) -> None:
    data = damaged(field, None)
    del data["cameras"][1][field]
    with pytest.raises(ConfigError, match=f"'{field}'") as caught:
        load_rig(write(tmp_path / "rig.json", data))
    assert "rig.json" in caught.value.where
    if field != "name":
        assert "cam1" in caught.value.where
    assert caught.value.fix


REFLECTION = np.diag([1.0, 1.0, -1.0]).tolist()
NAN = float("nan")


@pytest.mark.parametrize(
    ("field", "value", "message"),
    [
        ("K", [[600, 0, 320], [0, NAN, 240], [0, 0, 1]], "NaN or infinity"),
        ("dist", [0, 0, 0, 0, float("inf")], "NaN or infinity"),
        ("dist", [0, 0, 0], r"shape \(3,\), wanted \(5,\)"),
        ("dist", [0, 0, 0, 0, 10**400], "not a list of numbers"),
        ("t", [0, 0, "far"], "not a list of numbers"),
        ("t", [0, 0, None], "NaN or infinity|not a list of numbers"),
        ("t", [[0, 0, 0], [0]], "not a list of numbers"),
        ("t", {"x": 1}, "not a list of numbers"),
        ("R", REFLECTION, "left-handed"),
        ("R", (2.0 * np.eye(3)).tolist(), "not a rotation"),
        ("R", np.zeros((3, 3)).tolist(), "not a rotation"),
        ("K", [[-600, 0, 320], [0, 600, 240], [0, 0, 1]], "must be positive"),
        ("K", [[600, 0, 0], [0, 600, 0], [320, 240, 1]], "fx 0 cx"),  # transposed
        ("K", [[600, 9, 320], [0, 600, 240], [0, 0, 1]], "fx 0 cx"),  # skew
        ("size", [640, 0], "must be positive"),
        ("size", [640.5, 480], "whole"),
        ("size", [20_000, 480], "whole pixels"),
        ("t", [0, 0, 1e300], "above 1e6"),
        ("K", [[1e200, 0, 320], [0, 600, 240], [0, 0, 1]], "above 1e6"),
        ("name", 7, "'name'"),
        ("name", "cam0", "two cameras have one name"),
        ("name", "", "'name'"),
    ],
)
def test_a_wrong_value_is_named(tmp_path: Path, field: str, value: Any, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        load_rig(write(tmp_path / "rig.json", damaged(field, value)))


@pytest.mark.parametrize("data", [[], {}, {"cameras": []}, {"cameras": {}}, 3, None, "cameras"])
def test_a_file_without_cameras_is_named(tmp_path: Path, data: Any) -> None:
    with pytest.raises(ConfigError, match="'cameras'"):
        load_rig(write(tmp_path / "rig.json", data))


@pytest.mark.parametrize(
    ("content", "error", "message"),
    [
        (b'{"cameras": [', ConfigError, "line 1"),
        (b"", ConfigError, "not valid JSON"),
        (b"\xff\xfe\x00", InputError, "no UTF-8 text"),
        (b"[" * 100_000, ConfigError, "not valid JSON"),
        (b'{"cameras": ' + b"9" * 5000 + b"}", ConfigError, "not valid JSON"),
    ],
)
def test_a_damaged_file_is_named(
    tmp_path: Path, content: bytes, error: type[MocapdError], message: str
) -> None:
    path = tmp_path / "rig.json"
    path.write_bytes(content)
    with pytest.raises(error, match=message) as caught:
        load_rig(path)
    assert str(path) in str(caught.value)


def test_a_missing_file_and_a_folder_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        load_rig(tmp_path / "rig.json")
    with pytest.raises(InputError, match="cannot be read"):
        load_rig(tmp_path)


JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3),
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=3), inner, max_size=3)
    ),
    max_leaves=12,
)


@given(st.sampled_from(FIELDS), JSON)
def test_no_value_of_any_field_ends_in_another_error(field: str, value: Any) -> None:
    entry = copy.deepcopy(ENTRIES[0]) | {field: value}
    try:
        camera = camera_from_dict(entry, "rig.json")
    except ConfigError:
        return
    assert camera.K[0, 0] > 0
    assert np.isfinite(camera.t_m).all()


@given(JSON)
def test_no_entry_ends_in_another_error(entry: Any) -> None:
    with pytest.raises(ConfigError):
        camera_from_dict(entry, "rig.json")


def test_four_coefficients_of_distortion_are_k1_k2_p1_p2(tmp_path: Path) -> None:
    rig = load_rig(write(tmp_path / "rig.json", damaged("dist", [0.1, -0.2, 0.003, -0.004])))
    assert any(camera.dist.tolist() == [0.1, -0.2, 0.003, -0.004, 0.0] for camera in rig.cameras)


@pytest.mark.parametrize(
    ("per_metre", "said"),
    [
        (1000.0, r"km (apart|from).*millimetres: multiply it by 0\.001"),
        (100.0, r" m (apart|from).*centimetres: multiply it by 0\.01"),
        (1 / 0.0254, r" m (apart|from).*inches: multiply it by 0\.0254"),
    ],
)
def test_a_rig_that_stands_in_no_room_is_refused_with_its_likely_unit(
    tmp_path: Path, per_metre: float, said: str
) -> None:
    cameras = [camera_to_dict(camera) for camera in ring(3)]
    for one in cameras:
        one["t"] = [per_metre * value for value in one["t"]]
    with pytest.raises(ConfigError, match=said):
        load_rig(write(tmp_path / "rig.json", {"cameras": cameras}))
