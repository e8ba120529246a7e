"""The record of what is known: layers over each other, and files that an earlier version wrote."""

from pathlib import Path

import cv2
import numpy as np

from mocapd.calibration.calibration_file import from_saved, read_calibration
from mocapd.calibration.calibration_record import Calibration, ShirtColours, Wearer
from mocapd.types import Camera, LabelledPicture, Rig

OF_0_2 = """\
# The calibration of mocapd's cameras, made by `mocapd calibrate`, read by `mocapd run`.
schema = 1

[made]
when = 2026-11-21T10:00:00Z
by = "ann"
mocapd = "0.2.0"

[room]
method = "board"
rms_px = 0.4
play_area_cm = 0.3

[wearer]
stature_m = 1.71
personal_colours = true

[wearer.proportions]
arm_girth = 1.2

[board]
kind = "charuco"
columns = 5
rows = 7
square_m = 0.05
marker_m = 0.0375

[[camera]]
id = "left"
label = "left, on the shelf"
source = "usb:1-3:046d:0825:left"
size_px = [64, 48]
K = [[60.5, 0.0, 32.0], [0.0, 60.0, 24.0], [0.0, 0.0, 1.0]]
dist = [0.1, -0.2, 0.0, 0.0, 0.001]
R = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
t_m = [0.1, -1.2, 2.5]
rms_px = 0.31

[camera.colour]
picture = "colours/left-0123456789ab.png"
strokes = "colours/left-0123456789ab_strokes.png"
W = [[1.1, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.9]]
"""


def picture(shade: int = 100) -> LabelledPicture:
    labels = np.zeros((48, 64), np.uint8)
    labels[10:20, 10:20] = 3
    return LabelledPicture(np.full((48, 64, 3), shade, np.uint8), labels)


def rig(name: str) -> Rig:
    return Rig((Camera(name, (64, 48), np.eye(3), np.zeros(5), np.eye(3), np.zeros(3)),))


def test_a_file_that_an_earlier_version_wrote_is_read(tmp_path: Path) -> None:
    path, drawn = tmp_path / "calibration.toml", picture()
    path.write_text(OF_0_2)
    (tmp_path / "colours").mkdir()
    for suffix, pixels in (("", drawn.pixels), ("_strokes", drawn.labels)):
        cv2.imwrite(str(tmp_path / "colours" / f"left-0123456789ab{suffix}.png"), pixels)
    known = from_saved(read_calibration(path), path)
    assert known.rig is not None
    assert known.rig.names == ("left",)
    assert known.rig.cameras[0].K[0, 0] == 60.5
    assert known.wearer.stature_m == 1.71
    assert known.wearer.shape_factors is not None
    assert known.wearer.shape_factors.tolist() == [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.2]
    assert known.shirt is not None
    read, mine = known.shirt.white_balance["left"], known.shirt.model[0]
    np.testing.assert_array_equal(read.pixels, drawn.pixels)
    np.testing.assert_array_equal(read.labels, drawn.labels)
    np.testing.assert_array_equal(mine.labels, drawn.labels)
    # the wearer's own colours are brought to the model's light: redder here, and less blue
    blue, green, red = mine.pixels[0, 0].astype(int)
    assert blue < green < red


def test_the_stronger_wins_field_by_field() -> None:
    factors = np.linspace(0.9, 1.1, 7)
    weak = Calibration(
        rig("a"),
        Wearer(1.6, factors),
        ShirtColours((picture(1),), {"a": picture(2), "b": picture(3)}),
    )
    strong = Calibration(None, Wearer(1.8), ShirtColours((), {"b": picture(4)}))
    both = weak.overlaid(strong)
    assert both.rig is weak.rig
    assert both.wearer.stature_m == 1.8
    assert both.wearer.shape_factors is factors
    assert both.shirt is not None
    assert both.shirt.model[0].pixels[0, 0, 0] == 1
    shades = {name: one.pixels[0, 0, 0] for name, one in both.shirt.white_balance.items()}
    assert shades == {"a": 2, "b": 4}
    other = weak.overlaid(Calibration(rig("c"), shirt=ShirtColours((picture(5),))))
    assert other.rig is not None
    assert other.rig.names == ("c",)
    assert other.shirt is not None
    assert other.shirt.model[0].pixels[0, 0, 0] == 5


def test_nothing_known_changes_nothing() -> None:
    one = Calibration(rig("a"), Wearer(1.6), ShirtColours((picture(1),)))
    for both in (one.overlaid(Calibration()), Calibration().overlaid(one)):
        assert both.rig is one.rig
        assert both.wearer.stature_m == 1.6
        assert both.shirt is one.shirt


def test_a_stature_is_assumed_only_where_nobody_says() -> None:
    assert Calibration().assuming(1.75).wearer.stature_m == 1.75
    assert Calibration(wearer=Wearer(1.6)).assuming(1.75).wearer.stature_m == 1.6
