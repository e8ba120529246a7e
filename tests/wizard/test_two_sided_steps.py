"""The steps with a board that is printed on both sides, and cameras all around the wearer."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibrate.board.board_instant import BoardInstant, BoardObservation
from mocapd.calibrate.board.board_sightings import BoardSightings
from mocapd.calibrate.intrinsics.view_picking import rough_place
from mocapd.calibration.board_spec import corners_m
from mocapd.sim.board.board_picture import BoardFilm
from mocapd.types import Bytes
from mocapd.wizard.board.board_form import board_of, form_of
from mocapd.wizard.draft import Draft
from mocapd.wizard.extrinsics.extrinsics_step import ExtrinsicsStep
from mocapd.wizard.step import StepState
from mocapd.wizard.step_commands import Board
from tests.calibrate.seen_once import never_written
from tests.calibrate.two_sided_scene import (
    MIDDLE_M,
    PRINT,
    SPEC,
    Pose,
    cameras_around,
    hidden_from,
    lying,
    off_m,
    true_lenses,
    turned_poses,
    view_of,
)
from tests.sim.kept_film import kept
from tests.wizard.board_pictures import EMPTY, draft_cameras
from tests.wizard.context import FakeContext

RIG = cameras_around()
POSES = turned_poses(16)
ASKEW = replace(PRINT, back_shift_m=(0.006, -0.002))


@cache
def film(camera: int) -> BoardFilm:
    return BoardFilm(RIG[camera], ASKEW)


@cache
def pictures(place: int) -> dict[str, Bytes]:
    """What the cameras see of one place, the last of which is the floor; the wearer hides it from one."""
    return {name: never_written(one.copy()) for name, one in drawn()[place].items()}


@cache
def upside_down() -> dict[str, Bytes]:
    """The board on the floor with its back up."""
    return {name: never_written(one.copy()) for name, one in drawn()[-1].items()}


@kept
def drawn() -> list[dict[str, Bytes]]:
    """What the cameras see of each place, and of the floor with the back up."""
    places = [
        {
            camera.name: film(c).picture(*pose, seed=100 * c + place)
            for c, camera in enumerate(RIG)
            if c != hidden_from(place)
        }
        for place, pose in enumerate([*POSES, lying()])
    ]
    R, t_m = turned_over(lying())
    return [*places, {one.name: film(c).picture(R, t_m) for c, one in enumerate(RIG)}]


class Around:
    """The step Room with a board of this kind, its lenses known."""

    def __init__(self, folder: Path) -> None:
        draft = Draft(cameras=draft_cameras(RIG), board=SPEC, intrinsics=true_lenses(RIG))
        self.context = FakeContext(folder, draft)
        self.step = ExtrinsicsStep(self.context)
        self.step.enter()

    def show(self, shown: Iterable[Mapping[str, Bytes]], seconds: float = 0.3) -> None:
        """Each for so long; a camera that is not named sees nothing."""
        names = self.context.hub.names
        for one in shown:
            self.context.drive(self.step, dict.fromkeys(names, EMPTY) | dict(one), seconds)

    def told(self) -> str:
        problems = self.step.view().problems
        return "; ".join(f"{one.where}: {one.what} -- {one.fix}" for one in problems)


@pytest.mark.long
def test_cameras_all_around_are_found_and_a_back_glued_askew_is_told(tmp_path: Path) -> None:
    room = Around(tmp_path)
    assert "from either side" in room.step.view().sentence
    room.show(pictures(i) for i in range(len(POSES)))
    view = room.step.view()
    assert view.details["stage"] == "floor", room.told()
    assert "the side that says FRONT up" in view.sentence
    assert "the board: the back of the board is not glued in register" in room.told()
    assert "mm to the right and" in room.told()
    room.show([upside_down()], 2.5)
    assert room.step.view().state is StepState.FAILED
    assert "the floor: the board lies there on its front: its back is up" in room.told()
    room.show([{}, pictures(len(POSES))], 3.0)
    assert room.step.view().state is StepState.DONE, room.told()
    draft = room.context.draft
    assert draft.rig is not None
    assert draft.board == SPEC
    assert draft.floor_known
    error_m, scale = off_m(RIG, draft.rig)
    print(f"cameras within {100 * error_m.max():.2f} cm, scale {100 * scale:+.3f} %")
    assert error_m.max() <= 0.01
    assert abs(scale) <= 0.005


@pytest.mark.long
def test_the_camera_that_is_mirrored_is_named(tmp_path: Path) -> None:
    room = Around(tmp_path)
    for i in range(len(POSES)):
        shown = pictures(i)
        if "cam1" in shown:
            shown = shown | {"cam1": np.ascontiguousarray(shown["cam1"][:, ::-1])}
        room.show([shown])
        if room.step.view().state is StepState.FAILED:
            break
    assert "cam1: the pictures are mirrored" in room.told()
    assert room.context.draft.rig is None


def turned_over(pose: Pose) -> Pose:
    """The same board at the same place, its other side to the camera."""
    R, t_m = pose
    over = R @ np.diag([1.0, -1.0, -1.0])
    return over, t_m + R @ MIDDLE_M - over @ MIDDLE_M


def test_a_board_turned_over_slants_as_before_and_tells_something_new() -> None:
    thin = replace(PRINT, thickness_m=0.0, back_shift_m=(0.0, 0.0), back_turn_rad=0.0)
    poses = [(pose, turned_over(pose)) for pose in POSES]
    rig = {camera.name: camera for camera in RIG[:2]}
    seen = [
        [
            {name: view_of(camera, pose, 100 * k, thin) for name, camera in rig.items()}
            for pose in both
        ]
        for k, both in enumerate(poses, start=1)
    ]
    before, after = next(pair for pair in seen if all(None not in v.values() for v in pair))
    sizes_px = {name: camera.size_px for name, camera in rig.items()}
    sightings = BoardSightings(sizes_px, corners_m(SPEC))
    instants = []
    for index, views in ((100, before), (200, after), (300, after)):
        observed = {
            name: BoardObservation(replace(view, index=index), 0, 0.0)
            for name, view in views.items()
            if view is not None
        }
        instants.append(BoardInstant(index, 0, {}, observed))
    for name, one in instants[0].observations.items():
        other = instants[1].observations[name]
        assert one.view.back != other.view.back
        here, there = (rough_place(x.view, corners_m(SPEC), (640, 480)) for x in (one, other))
        assert here is not None
        assert there is not None
        np.testing.assert_allclose(here, there, atol=0.02)
    assert [sightings.offer(instant) for instant in instants] == [True, True, False]


def test_the_form_says_whether_there_is_a_back() -> None:
    assert form_of(SPEC)["two_sided"] is True
    assert not board_of(Board(two_sided=False), SPEC).two_sided
    assert board_of(Board(columns=6), SPEC).two_sided
