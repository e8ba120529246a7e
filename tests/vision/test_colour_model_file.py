"""Colour model files: what is written is read; anything damaged is refused by name."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from mocapd.errors import CannotCreateError, ConfigError, InputError
from mocapd.vision.colour_model_file import load_colour_model, save_colour_model
from tests.vision.naive import example_model


def test_round_trip_is_exact(tmp_path: Path) -> None:
    model = example_model().tolerating(0.2, 0.03)
    save_colour_model(model, tmp_path / "model.json")
    read = load_colour_model(tmp_path / "model.json")
    assert read.names == model.names
    assert read.version == model.version
    assert (read.shading_sigma, read.noise_sigma) == (0.2, 0.03)
    assert (read.mean == model.mean).all()
    assert (read.covariance == model.covariance).all()
    assert [path.name for path in tmp_path.iterdir()] == ["model.json"]


def damaged(tmp_path: Path, key: str, value: Any, colour: int | None = None) -> Path:
    path = tmp_path / "model.json"
    save_colour_model(example_model(), path)
    content = json.loads(path.read_text())
    (content if colour is None else content["colours"][colour - 1])[key] = value
    path.write_text(json.dumps(content))
    return path


@pytest.mark.parametrize(
    ("key", "value", "colour", "message"),
    [
        ("schema", 99, None, "schema 99"),
        ("colours", [], None, "no colour with id 1, 2"),
        ("id", 11, 4, "no colour with id 4"),
        ("mean", [0.1, float("nan"), 0.2], 7, "'mean' of colour 7 contains NaN"),
        ("mean", [0.1, 0.2], 7, "'mean' of colour 7 is missing or not of shape"),
        ("mean", "blue", 7, "'mean' of colour 7 is not a list of numbers"),
        ("covariance", (-np.eye(3)).tolist(), 2, "'covariance' of colour 2 is not positive"),
        ("shading_sigma", -1, None, "'shading_sigma' is -1"),
        ("noise_sigma", "much", None, "'noise_sigma' is 'much'"),
    ],
)
def test_a_damaged_value_is_named(
    tmp_path: Path, key: str, value: Any, colour: int | None, message: str
) -> None:
    path = damaged(tmp_path, key, value, colour)
    with pytest.raises(ConfigError, match=message) as caught:
        load_colour_model(path)
    assert str(path) in str(caught.value)


def test_half_a_file_and_no_file(tmp_path: Path) -> None:
    path = tmp_path / "model.json"
    save_colour_model(example_model(), path)
    path.write_text(path.read_text()[:200])
    with pytest.raises(ConfigError, match="not valid JSON"):
        load_colour_model(path)
    with pytest.raises(InputError, match="no such file"):
        load_colour_model(tmp_path / "other.json")


def test_a_failed_write_is_reported(tmp_path: Path) -> None:
    with pytest.raises(CannotCreateError, match="cannot be written"):
        save_colour_model(example_model(), tmp_path / "no such folder" / "model.json")
