"""A calibration that an earlier mocapd saved loads, and says what it said then."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibration.calibration_file import FILE_NAME, from_saved, read_calibration

# As mocapd of 2026-11-21 wrote it, before what is known of cameras, wearer and shirt became one record.
OF_2026_11_21 = Path(__file__).parent / "of_2026_11_21"


def test_one_of_2026_11_21_loads_with_all_that_it_holds(tmp_path: Path) -> None:
    shutil.copytree(OF_2026_11_21, tmp_path / "state")
    path = tmp_path / "state" / FILE_NAME
    saved = read_calibration(path)
    assert [one.source for one in saved.camera] == [
        "usb:1-3:046d:0825:left",
        "usb:1-3:046d:0825:right",
    ]
    assert saved.camera[1].controls is not None
    assert saved.camera[1].controls.exposure == 150
    assert saved.board is not None
    assert saved.board.square_m == 0.05

    known = from_saved(saved, path).assuming(1.9)
    assert known.rig is not None
    left, right = known.rig.cameras
    assert (left.name, right.name) == ("left", "right")
    assert left.K[0, 0] == 60.123456789
    assert left.dist.tolist() == [0.1, -0.2, 0.0, 0.0, 0.001]
    assert right.t_m.tolist() == [-0.3, 1.1, 2.7]
    assert right.R[0, 2] == pytest.approx(np.sin(0.5))
    assert known.wearer.stature_m == 1.71
    assert known.wearer.shape_factors is not None
    assert known.wearer.shape_factors.tolist() == [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.2]
    assert known.shirt is not None
    assert len(known.shirt.model) == 1  # personal colours
    picture = known.shirt.white_balance["left"]
    assert picture.pixels[15, 15].tolist() == [200, 30, 60]
    assert picture.pixels[0, 0].tolist() == [40, 60, 80]
    assert (picture.labels[15, 15], picture.labels[35, 45], picture.labels[0, 0]) == (3, 7, 0)
