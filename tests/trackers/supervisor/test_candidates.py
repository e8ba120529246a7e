"""Which trackers the supervisor is made of: what the rig and the clothes suit, and what is said of it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.errors import ConfigError
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.shirt.pose_database.cache_name import CACHE_NAME
from mocapd.trackers.flex.params import Params
from mocapd.trackers.registry import Resources, build, has_caches, shirt_tracker
from mocapd.trackers.supervisor.supervisor import Supervisor
from mocapd.types import Rig

pytestmark = pytest.mark.kernels


def known(*places_m: float) -> Calibration:
    """Cameras side by side, at these places along x."""
    one = nominal_rig("cam0", (320, 240)).cameras[0]
    cameras = [
        replace(one, name=f"cam{i}", t_m=one.t_m - one.R @ np.array([x, 0.0, 0.0]))
        for i, x in enumerate(places_m)
    ]
    return Calibration(Rig(tuple(cameras)), Wearer(1.7))


@pytest.fixture(scope="module")
def resources(cache_home: Path) -> Resources:
    return Resources(cache_home / "mocapd")


def built(calibration: Calibration, resources: Resources) -> tuple[list[str], list[str]]:
    """The names of what it is made of, and what was said."""
    said: list[str] = []
    tracker = build("auto", calibration, replace(resources, tell=said.append))
    assert isinstance(tracker, Supervisor)
    return [one.name for one in tracker.candidates], said


def test_one_camera_has_the_shirt_alone_and_that_is_no_trouble(resources: Resources) -> None:
    assert built(known(0.0), resources) == (["colour"], [])


def test_a_pair_has_both_the_shirt_first(resources: Resources) -> None:
    assert built(known(0.0, 0.2), resources) == (["colour", "flex"], [])


def test_a_pair_in_one_place_has_the_shirt_alone_and_that_is_said_once(
    resources: Resources,
) -> None:
    names, said = built(known(0.0, 0.0), resources)
    assert names == ["colour"]
    assert len(said) == 1
    assert "'flex'" in said[0]
    assert "in one" in said[0]


def test_somebody_without_a_shirt_needs_no_pose_database(tmp_path: Path) -> None:
    wearer = replace(known().wearer, has_shirt=False)
    calibration = replace(known(0.0, 0.2), wearer=wearer)
    assert built(calibration, Resources(tmp_path)) == (["flex"], [])
    assert not (tmp_path / CACHE_NAME).exists()


def test_without_a_shirt_one_camera_does_not_do(tmp_path: Path) -> None:
    calibration = replace(known(0.0), wearer=replace(known().wearer, has_shirt=False))
    with pytest.raises(ConfigError, match=r"'flex'.*needs two"):
        built(calibration, Resources(tmp_path))


def test_a_study_gives_a_tracker_below_other_numbers(tmp_path: Path) -> None:
    calibration = replace(known(0.0, 0.2), wearer=replace(known().wearer, has_shirt=False))
    params = {"flex": replace(Params(), live_explained=0.33)}
    tracker = build("auto", calibration, Resources(tmp_path, params=params))
    assert isinstance(tracker, Supervisor)
    assert tracker.candidates[0].tracker.params.live_explained == 0.33  # type: ignore[attr-defined]


def test_a_setup_measures_with_the_shirts_own_tracker_and_finds_its_cache(tmp_path: Path) -> None:
    assert shirt_tracker("auto") == "colour"
    assert not has_caches("auto", tmp_path)
    (tmp_path / CACHE_NAME).write_bytes(b"")
    assert has_caches("auto", tmp_path)
