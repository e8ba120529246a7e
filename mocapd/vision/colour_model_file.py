"""Colour model files: JSON, checked value by value, written whole or not at all."""

import json
from pathlib import Path
from typing import Any

import numpy as np

from mocapd.errors import CannotCreateError, ConfigError
from mocapd.geometry.rig_file import read_json
from mocapd.types import Floats
from mocapd.vision.colour_model import ColourModel
from mocapd.vision.strokes import COLOURS
from mocapd.whole_file import whole_file

SCHEMA = 1
_MAKE_AGAIN = "make the colour model again from the labelled images"


def save_colour_model(model: ColourModel, path: Path) -> None:
    """Write `model` to `path`; an old file stays as it was if this fails. Raises CannotCreateError."""
    content = {
        "schema": SCHEMA,
        "version": model.version,
        "shading_sigma": model.shading_sigma,
        "noise_sigma": model.noise_sigma,
        "colours": [
            {"id": k + 1, "name": name, "mean": mean.tolist(), "covariance": covariance.tolist()}
            for k, (name, mean, covariance) in enumerate(
                zip(model.names, model.mean, model.covariance, strict=True)
            )
        ],
    }
    text = json.dumps(content, indent=1, allow_nan=False) + "\n"
    try:
        with whole_file(path) as partial:
            partial.write_text(text, encoding="utf-8")
    except OSError as error:
        raise CannotCreateError(
            f"the colour model cannot be written ({error.strerror})",
            str(path),
            "choose a folder that exists and is yours to write",
        ) from None


def load_colour_model(path: Path) -> ColourModel:
    """The model in `path`. Raises InputError or ConfigError that names the file and the value."""
    content = read_json(path)
    where = str(path)
    if not isinstance(content, dict) or "schema" not in content:
        raise ConfigError("is not a colour model", where, _MAKE_AGAIN)
    if content["schema"] != SCHEMA:
        raise ConfigError(
            f"has schema {content['schema']!r}, this mocapd reads {SCHEMA}", where, _MAKE_AGAIN
        )
    entries = content.get("colours")
    by_id = {
        entry.get("id"): entry
        for entry in (entries if isinstance(entries, list) else [])
        if isinstance(entry, dict)
    }
    missing = [str(k) for k in range(1, COLOURS + 1) if k not in by_id]
    if missing:
        raise ConfigError(f"has no colour with id {', '.join(missing)}", where, _MAKE_AGAIN)
    ordered = [by_id[k] for k in range(1, COLOURS + 1)]
    covariances = [_numbers(entry, "covariance", (3, 3), where) for entry in ordered]
    for entry, covariance in zip(ordered, covariances, strict=True):
        if (covariance != covariance.T).any() or np.linalg.eigvalsh(covariance).min() <= 0:
            raise ConfigError(
                f"'covariance' of colour {entry['id']} is not positive definite", where, _MAKE_AGAIN
            )
    return ColourModel(
        names=tuple(str(entry.get("name", entry["id"])) for entry in ordered),
        mean=np.array([_numbers(entry, "mean", (3,), where) for entry in ordered]),
        covariance=np.array(covariances),
        version=str(content.get("version", "")),
        shading_sigma=_tolerance(content, "shading_sigma", where),
        noise_sigma=_tolerance(content, "noise_sigma", where),
    )


def _numbers(entry: dict[str, Any], key: str, shape: tuple[int, ...], where: str) -> Floats:
    named = f"{key!r} of colour {entry['id']}"
    try:
        value = np.asarray(entry.get(key), dtype=float)
    except (TypeError, ValueError):
        raise ConfigError(f"{named} is not a list of numbers", where, _MAKE_AGAIN) from None
    if value.shape != shape:
        raise ConfigError(f"{named} is missing or not of shape {shape}", where, _MAKE_AGAIN)
    if not np.isfinite(value).all():
        raise ConfigError(f"{named} contains NaN or infinity", where, _MAKE_AGAIN)
    return value


def _tolerance(content: dict[str, Any], key: str, where: str) -> float:
    value = content.get(key, 0.0)
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 <= value < 10.0:
        raise ConfigError(
            f"{key!r} is {value!r}, wanted 0 or a positive number", where, _MAKE_AGAIN
        )
    return float(value)
