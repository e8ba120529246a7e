"""Trackers without the shirt say what they lack of a pair of cameras: where they are, a second one, a second place; that
of the visual hull needs a third."""

from dataclasses import replace

import numpy as np
import pytest

from mocapd.calibration.calibration_record import Calibration, Wearer
from mocapd.errors import ConfigError
from mocapd.geometry.camera_model import centre
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.trackers.registry import Resources, build
from mocapd.types import Rig

(ONE,) = nominal_rig("left", (320, 240)).cameras
PERSON = Wearer(1.75, has_shirt=False)
NAMES = ("markerless", "hecht2009", "rao_hodges", "auto")


@pytest.mark.parametrize("name", NAMES)
def test_cameras_that_are_not_calibrated(name: str) -> None:
    with pytest.raises(ConfigError, match="needs to know where the cameras are"):
        build(name, Calibration(None, PERSON), Resources())


@pytest.mark.parametrize("name", NAMES)
def test_one_camera_alone(name: str) -> None:
    with pytest.raises(ConfigError, match="needs two of the calibrated cameras"):
        build(name, Calibration(Rig((ONE,)), PERSON), Resources())


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("apart_m", [0.0, 0.01])
def test_two_cameras_in_one_place(name: str, apart_m: float) -> None:
    other = replace(ONE, name="right", t_m=ONE.t_m - np.array([apart_m, 0.0, 0.0]))
    assert np.linalg.norm(centre(other) - centre(ONE)) == pytest.approx(apart_m)
    with pytest.raises(ConfigError, match="by the calibration all are in one"):
        build(name, Calibration(Rig((ONE, other)), PERSON), Resources())


def test_a_hull_of_two_silhouettes() -> None:
    pair = Rig((ONE, replace(ONE, name="right", t_m=ONE.t_m - np.array([1.0, 0.0, 0.0]))))
    with pytest.raises(ConfigError, match="needs three of the calibrated cameras"):
        build("rao_hodges", Calibration(pair, PERSON), Resources())
