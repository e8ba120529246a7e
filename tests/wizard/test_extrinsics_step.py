"""The step Room with the board, driven by pictures of a simulated board."""

import json
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.calibrate.board.board_detection import BoardDetector, BoardView
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.errors import InputError
from mocapd.geometry.camera_model import centre, normalised, project
from mocapd.geometry.triangulation import triangulate
from mocapd.types import Bytes, Rig
from mocapd.wizard.draft import Draft
from mocapd.wizard.extrinsics.extrinsics_step import ExtrinsicsStep
from mocapd.wizard.step import Scene, StepState
from tests.wizard.board_pictures import (
    EMPTY,
    RIG,
    SPEC,
    close_pictures,
    draft_cameras,
    floor_pictures,
    held_pictures,
)
from tests.wizard.context import FakeContext, do

pytestmark = pytest.mark.long

STILL_S = 0.2
FEW = 7  # of the close pictures are enough where the lens is known, or nearly


def lens(camera: int, off: float = 0.0) -> Intrinsics:
    """The camera's true lens, its focal length wrong by a part `off`."""
    K = RIG[camera].K.copy()
    K[:2, :2] *= 1.0 + off
    free = np.array([True, True, True, True, True])
    return Intrinsics((640, 480), K, RIG[camera].dist, free, 0.1, 0.1, (), (), 0.003)


def lens_views() -> dict[str, dict[int, BoardView]]:
    """What a lens step of a board held before one camera after the other leaves behind."""
    detector = BoardDetector(SPEC)
    views: dict[str, dict[int, BoardView]] = {"cam0": {}, "cam1": {}}
    for camera, name in enumerate(views):
        for i, picture in enumerate(close_pictures(camera, first=FEW)):
            view = detector.find(picture, 1000 * (camera + 1) + 10 * i)
            assert view is not None
            views[name][view.index] = view
    return views


class Room:
    """The step with cameras that see what a test shows them."""

    def __init__(self, folder: Path, draft: Draft) -> None:
        self.context = FakeContext(folder, draft)
        self.step = ExtrinsicsStep(self.context)
        self.step.enter()

    def show(self, pictures: Iterable[Mapping[str, Bytes]], seconds: float = STILL_S) -> None:
        """Each for so long; a camera that is not named sees nothing."""
        names = self.context.hub.names
        for shown in pictures:
            self.context.drive(self.step, dict.fromkeys(names, EMPTY) | dict(shown), seconds)

    def told(self) -> str:
        problems = self.step.view().problems
        return "; ".join(f"{one.where}: {one.what} -- {one.fix}" for one in problems)


def drafted(cameras: int = 2, off: float = 0.0, **more: object) -> Draft:
    lenses = {RIG[i].name: lens(i, off) for i in range(cameras)}
    draft = Draft(cameras=draft_cameras(RIG[:cameras]), board=SPEC, intrinsics=lenses)
    return replace(draft, **more)  # type: ignore[arg-type]


def off_cm(rig: Rig) -> float:
    """Median distance of triangulated points of the play area from where they are."""
    points_m = np.random.default_rng(0).uniform([-0.3, 0.05, -0.3], [0.3, 0.5, 0.3], (500, 3))
    pixels = [project(camera, points_m) for camera in RIG]
    seen = np.stack([normalised(c, px) for c, px in zip(rig.cameras, pixels, strict=True)])
    found_m, _ = triangulate(rig.cameras, seen)
    return float(100.0 * np.median(np.linalg.norm(found_m - points_m, axis=1)))


@pytest.fixture(scope="module")
def solved(tmp_path_factory: pytest.TempPathFactory) -> Room:
    """A room of which the floor is still to be found."""
    draft = drafted(board_views=lens_views(), off=0.004)
    room = Room(tmp_path_factory.mktemp("room"), draft)
    room.show(held_pictures())
    return room


def test_the_room_and_its_floor_are_found_by_themselves(solved: Room) -> None:
    room = solved
    assert room.context.scenes == [Scene.ROOM, Scene.FLOOR]
    view = room.step.view()
    assert view.details["stage"] == "floor"
    assert room.context.draft.rig is None
    room.show([floor_pictures()], 2.5)
    view = room.step.view()
    assert view.state is StepState.DONE
    assert room.context.scenes[-1] is Scene.EMPTY
    draft = room.context.draft
    assert draft.rig is not None
    assert draft.extrinsics_quality is not None
    for true, found in zip(RIG, draft.rig.cameras, strict=True):
        focal = np.diag(found.K)[:2] / np.diag(true.K)[:2] - 1.0
        off_m = np.linalg.norm(centre(true) - centre(found))
        print(f"{true.name}: focal {100 * focal} %, position {100 * off_m:.3f} cm")
        assert np.abs(focal).max() <= 0.005
        assert off_m <= 0.01
    print(f"triangulated point: {off_cm(draft.rig):.3f} cm")
    assert off_cm(draft.rig) <= 0.5
    assert draft.floor_known
    assert draft.extrinsics_quality.method == "board"
    assert draft.extrinsics_quality.play_area_cm < 0.5
    assert draft.extrinsics_quality.rms_px < 0.3
    assert set(draft.extrinsics_quality.camera_rms_px) == {"cam0", "cam1"}
    assert json.dumps(view.details)


def test_lenses_of_before_are_enough(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted())
    room.show([*held_pictures(), *[floor_pictures()] * 12])
    draft = room.context.draft
    assert draft.rig is not None
    print(f"triangulated point: {off_cm(draft.rig):.3f} cm")
    assert off_cm(draft.rig) <= 0.5
    for true, found in zip(RIG, draft.rig.cameras, strict=True):
        assert np.linalg.norm(centre(true) - centre(found)) <= 0.01


def test_a_board_in_one_camera_only_is_said(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted())
    before = room.context.draft
    room.show([{"cam0": picture} for picture in close_pictures(0, first=FEW)], 1.4)
    for name in ("cam0", "cam1"):
        assert f"{name}: it never sees the board at the same moment as another" in room.told()
    assert room.step.view().state is StepState.WAITING
    assert room.context.draft is before
    room.show(held_pictures()[:1])
    assert room.told() == ""


def test_a_board_that_moves_is_no_moment(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted())
    shown = held_pictures()[0]
    moving = [
        {name: np.roll(picture, 3 * i, axis=1) for name, picture in shown.items()}
        for i in range(10)
    ]
    room.show(moving, 0.05)
    assert room.step.view().details["moments"] == 0
    room.show(moving[-1:])
    assert room.step.view().details["moments"] == 1


def test_pictures_that_contradict_each_other_are_refused_and_the_step_goes_on(
    tmp_path: Path,
) -> None:
    room = Room(tmp_path, drafted())
    before = room.context.draft
    held = held_pictures()
    room.show(
        {"cam0": a["cam0"], "cam1": b["cam1"]}
        for a, b in zip(held, held[3:] + held[:3], strict=True)
    )
    assert room.step.view().state is StepState.FAILED
    assert "the cameras contradict each other" in room.told()
    assert room.context.draft is before
    # twice: the first of them may be thrown away with the last wrong ones
    room.show([*held, *held, *[floor_pictures()] * 12])
    assert room.step.view().state is StepState.DONE
    assert room.context.draft.rig is not None
    assert off_cm(room.context.draft.rig) <= 0.5


def test_cameras_moved_since_the_lens_step_are_no_trouble(tmp_path: Path) -> None:
    views = lens_views()
    detector = BoardDetector(SPEC)
    held = held_pictures()
    for i, (a, b) in enumerate(zip(held[:6], held[4:10], strict=True)):  # as if one had been moved
        pair = {n: detector.find(p[n], 5000 + 10 * i) for n, p in (("cam0", a), ("cam1", b))}
        for name, view in pair.items():
            if None not in pair.values() and view is not None:
                views[name][view.index] = view
    assert len(views["cam0"].keys() & views["cam1"].keys()) >= 4
    room = Room(tmp_path, drafted(board_views=views))
    room.show([*held, *[floor_pictures()] * 12])
    draft = room.context.draft
    assert draft.rig is not None
    assert off_cm(draft.rig) <= 0.5


def test_the_floor_is_where_the_person_says(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted())
    with pytest.raises(InputError, match="not known yet"):
        do(room.step, "floor", {})
    room.show(held_pictures())
    room.show([{}])
    with pytest.raises(InputError, match="no camera sees the board lie still"):
        do(room.step, "floor", {})
    room.show([floor_pictures()], 0.6)
    do(room.step, "floor", {})
    assert room.step.view().state is StepState.DONE
    assert room.context.draft.floor_known


def test_a_board_held_up_is_not_taken_for_the_floor(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted())
    room.show(held_pictures())
    room.show(held_pictures()[:1], 3.0)
    assert room.step.view().details["stage"] == "floor"


def test_a_guessed_floor_is_called_one(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted())
    with pytest.raises(InputError, match="not known yet"):
        do(room.step, "skip_floor", {})
    room.show(held_pictures())
    do(room.step, "skip_floor", {})
    view = room.step.view()
    assert view.state is StepState.DONE
    assert "the floor is guessed" in room.told()
    assert not room.context.draft.floor_known
    assert room.context.draft.rig is not None
    for camera in room.context.draft.rig.cameras:
        assert -camera.R[1, 1] > 0.5  # up in the picture is up in the world


def test_one_camera_is_placed_by_the_floor_alone(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted(1))
    assert room.context.scenes == [Scene.FLOOR]
    with pytest.raises(InputError, match="lay the board on the floor"):
        do(room.step, "skip_floor", {})
    room.show([{"cam0": floor_pictures()["cam0"]}], 2.5)
    draft = room.context.draft
    assert room.step.view().state is StepState.DONE
    assert draft.rig is not None
    assert draft.extrinsics_quality is not None
    assert np.isnan(draft.extrinsics_quality.play_area_cm)
    assert np.linalg.norm(centre(draft.rig.cameras[0])[1] - centre(RIG[0])[1]) <= 0.01
    assert json.dumps(room.step.view().details, allow_nan=False)


def test_a_camera_that_stops_is_told_and_the_step_goes_on_with_it(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted())
    held = held_pictures()
    room.show(held[:3])
    room.context.lost["cam1"] = "it was unplugged"
    for shown in held[3:5]:
        room.context.drive(room.step, {"cam0": shown["cam0"]}, 1.0)
    assert "cam1: the camera stopped: it was unplugged" in room.told()
    assert room.step.view().details["moments"] == 3
    del room.context.lost["cam1"]
    room.show(held[3:6])
    assert room.step.view().details["moments"] == 6


def test_fewer_places_are_solved_when_asked_for(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted())
    with pytest.raises(InputError, match="nothing to solve"):
        do(room.step, "solve", {})
    room.show(held_pictures()[:6])
    assert room.step.view().details["can_solve"]
    do(room.step, "solve", {})
    room.show([{}])
    assert room.step.view().details["stage"] == "floor"


def test_a_room_without_lenses_is_refused(tmp_path: Path) -> None:
    draft = drafted()
    with pytest.raises(InputError, match="the lens of cam1 is not known"):
        ExtrinsicsStep(FakeContext(tmp_path, replace(draft, intrinsics={"cam0": lens(0)})))


def test_commands_and_methods_that_are_not_there_are_refused(tmp_path: Path) -> None:
    room = Room(tmp_path, drafted())
    with pytest.raises(InputError, match="no command 'paint'"):
        do(room.step, "paint", {})
    with pytest.raises(InputError, match="no such method"):
        do(room.step, "method", {"method": "magic"})
    assert room.step.view().details["method"] == "board"
