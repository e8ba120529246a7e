"""The picture, drawn off-screen by Panda3D's own renderer; without Panda3D only where nobody requires it."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.types import Bytes

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("panda3d") is None and not os.environ.get("MOCAPD_REQUIRE_CLIENTS"),
    reason="Panda3D is not installed (pip install panda3d)",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What `drawn.py` writes."""
    folder = tmp_path_factory.mktemp("drawn")
    environment = dict(os.environ) | {"PYTHONPATH": ":".join(p for p in sys.path if p)}
    done = subprocess.run(
        [sys.executable, "-m", "tests.clients.goalkeeper.drawn", str(folder)],
        capture_output=True,
        text=True,
        check=False,
        env=environment,
        cwd=Path(__file__).parents[3],
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return folder


@pytest.fixture(scope="module")
def drawn(folder: Path) -> dict[str, Bytes]:
    """Pictures by name, BGR."""
    return {path.stem: np.asarray(cv2.imread(str(path))) for path in folder.glob("*.png")}


def _changed(drawn: dict[str, Bytes], name: str) -> Bytes:
    """Where the picture is not that of the stadium alone."""
    moved = np.abs(drawn[name].astype(int) - drawn["empty"]).max(axis=2) > 40
    changed: Bytes = moved.astype(np.uint8)
    return changed


def test_from_behind_the_left_hand_is_up_on_the_left(drawn: dict[str, Bytes]) -> None:
    keeper = _changed(drawn, "behind")
    rows, columns = np.nonzero(keeper)
    middle = np.median(columns)
    top = columns[rows < np.percentile(rows, 3)]
    assert top.mean() < middle - 4
    assert keeper.shape == (270, 480)
    assert 0.01 < keeper.mean() < 0.30


def test_the_stadium_has_grass_below_and_people_above(drawn: dict[str, Bytes]) -> None:
    blue, green, red = (drawn["empty"][..., k].astype(int) for k in range(3))
    grass = (green > blue + 20) & (green > red + 20)
    assert grass[200:].mean() > 0.5
    assert grass[:28].mean() < 0.1
    assert drawn["empty"][5:30].std() > 15


def test_from_behind_the_shooter_is_not_hidden_by_the_keeper(drawn: dict[str, Bytes]) -> None:
    """He wears blue, and is seen above the keeper's head."""
    blue, green, red = (drawn["behind"][..., k].astype(int) for k in range(3))
    shooter = (blue > 110) & (green < 70) & (red < 70)
    rows, columns = np.nonzero(shooter[:, 200:280])
    keeper_rows, _ = np.nonzero(_changed(drawn, "behind")[:, 200:280])
    assert len(rows) > 15
    assert rows.max() < np.percentile(keeper_rows, 90)
    assert len(columns) > 15


def test_in_first_person_ones_own_head_is_not_in_the_way(drawn: dict[str, Bytes]) -> None:
    grass = drawn["first"][150:, 160:320].astype(int)
    assert (
        (grass[..., 1] > grass[..., 0] + 15) & (grass[..., 1] > grass[..., 2] + 15)
    ).mean() > 0.3


def test_texts_fit_into_a_window_of_any_shape_and_do_not_lie_on_each_other(folder: Path) -> None:
    for shape, texts in json.loads((folder / "texts.json").read_text()).items():
        assert {"score", "clock", "keys", "foot", "message", "popup", "table"} <= set(texts)
        for name, (left, right, lower, upper) in texts.items():
            assert -1.0 <= left < right <= 1.0, (shape, name)
            assert -1.0 <= lower < upper <= 1.0, (shape, name)
        beside = texts["keys"][1] < texts["foot"][0]
        assert beside or texts["keys"][2] > texts["foot"][2], shape
        assert texts["score"][1] < texts["clock"][0], shape
        assert texts["clock"][1] < texts["streak"][0], shape
