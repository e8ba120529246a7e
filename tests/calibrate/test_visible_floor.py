"""Where a person is seen whole, and the advice about the rig."""

import numpy as np
import pytest

from mocapd.calibrate.extrinsics.visible_floor import rig_advice, visible_floor
from mocapd.geometry.camera_model import project
from mocapd.types import Rig
from mocapd.wizard.extrinsics.rig_plan import area_shapes, plan_of_cameras
from tests.geometry.rigs import looking_at


def pair(apart_m: float, away_m: float) -> Rig:
    """Two cameras before the origin, turned to it."""
    target_m = np.array([0.0, 1.0, 0.0])
    return Rig(
        tuple(
            looking_at(name, np.array([x_m, 1.5, away_m]), target_m)
            for name, x_m in (("left", -apart_m / 2), ("right", apart_m / 2))
        )
    )


def test_a_person_in_a_cell_is_in_both_pictures_from_foot_to_head() -> None:
    rig = pair(3.0, 3.0)
    seen = visible_floor(rig)
    assert seen.area_m2 > 2.0
    assert seen.baseline_m == pytest.approx(3.0)
    for x_m, z_m in seen.cells_m[::7]:
        for camera in rig.cameras:
            ends_px = project(camera, np.array([[x_m, 0.05, z_m], [x_m, 1.85, z_m]]))
            assert ((ends_px >= 0) & (ends_px < camera.size_px)).all()
    assert seen.cells_m[:, 1].max() < 2.0, "nothing between the cameras"
    assert not [*rig_advice(seen, 2)]


def test_cameras_that_are_too_near_are_told_to_move_back() -> None:
    (told,) = rig_advice(visible_floor(pair(1.2, 1.2)), 2)
    assert told.where == "the play area"
    assert told.what == "both cameras see a person whole nowhere on the floor"
    assert "2.5 to 3.5 m" in told.fix


def test_cameras_side_by_side_are_told_to_move_apart() -> None:
    (told,) = rig_advice(visible_floor(pair(0.4, 3.2)), 2)
    assert told.where == "depth"
    assert "0.4 m apart" in told.what


def test_the_page_gets_the_figures_in_metres() -> None:
    plan = plan_of_cameras(pair(3.0, 3.0))
    assert plan["baseline_m"] == 3.0
    assert plan["angle_deg"] == pytest.approx(53, abs=12)
    assert len(plan["seen_m"]) > 50  # type: ignore[arg-type]
    alone = plan_of_cameras(Rig(pair(3.0, 3.0).cameras[:1]))
    assert (alone["baseline_m"], alone["angle_deg"]) == (0.0, None)


def test_the_area_is_drawn_into_each_picture_with_its_size() -> None:
    rig = pair(3.0, 3.0)
    shapes, seen = area_shapes(rig), visible_floor(rig)
    assert set(shapes) == {"left", "right"}
    for camera in rig.cameras:
        outline, text = shapes[camera.name]
        assert text.text == f"{seen.size_m[0]:.1f} x {seen.size_m[1]:.1f} m"
        at_px = np.array(outline.at_px)
        assert ((at_px >= 0) & (at_px < camera.size_px)).all(), "it is floor that the camera sees"
    assert area_shapes(None) == {}
