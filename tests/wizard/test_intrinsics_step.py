"""The step Intrinsics, driven by pictures of a simulated board."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from mocapd.body.shape import N_FACTORS
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics
from mocapd.calibration.board_spec import BoardKind, BoardSpec
from mocapd.errors import InputError, MocapdError
from mocapd.types import Bytes, Rig
from mocapd.wizard.board.board_form import usual_board
from mocapd.wizard.draft import Draft, ExtrinsicsQuality
from mocapd.wizard.intrinsics.intrinsics_step import IntrinsicsStep
from mocapd.wizard.step import Scene, StepState
from tests.wizard.board_pictures import (
    EMPTY,
    RIG,
    SPEC,
    close_pictures,
    draft_cameras,
    held_pictures,
)
from tests.wizard.context import FakeContext, do

pytestmark = pytest.mark.long

STILL_S = 0.2  # how long each place is shown


class Shown:
    """The step with cameras that see what a test shows them."""

    def __init__(self, folder: Path, board: BoardSpec = SPEC, cameras: int = 2) -> None:
        self.context = FakeContext(folder, Draft(cameras=draft_cameras(RIG[:cameras]), board=board))
        self.step = IntrinsicsStep(self.context)
        self.step.enter()

    def show(self, pictures: Iterable[dict[str, Bytes]], seconds: float = STILL_S) -> None:
        """Each for so long; a camera that is not named sees nothing."""
        names = self.context.hub.names
        for shown in pictures:
            self.context.drive(self.step, dict.fromkeys(names, EMPTY) | shown, seconds)

    def details(self, camera: str) -> dict[str, object]:
        cameras = self.step.view().details["cameras"]
        assert isinstance(cameras, dict)
        return dict(cameras[camera])

    def told(self) -> str:
        """All problems in one text."""
        problems = self.step.view().problems
        return "; ".join(f"{one.where}: {one.what} -- {one.fix}" for one in problems)


def to(camera: int, pictures: Sequence[Bytes]) -> list[dict[str, Bytes]]:
    return [{RIG[camera].name: picture} for picture in pictures]


def test_lenses_are_found_by_themselves(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    before = shown.context.draft
    shown.show(to(0, close_pictures(0)))
    assert shown.details("cam0")["lens"] is not None
    assert shown.context.draft is before  # nothing is changed as long as one is missing
    assert "cam1" in shown.step.view().sentence or "cameras" in shown.step.view().sentence
    shown.show(to(1, close_pictures(1)))
    view = shown.step.view()
    assert view.state is StepState.DONE
    assert view.progress == 1.0
    assert shown.context.scenes == [Scene.LENS]
    for true in RIG:
        lens = shown.context.draft.intrinsics[true.name]
        focal = np.diag(lens.K)[:2] / np.diag(true.K)[:2] - 1.0
        print(true.name, 100 * focal, "%", lens.rms_px, lens.held_out_px)
        assert np.abs(focal).max() <= 0.005
        assert 0.0 < lens.rms_px <= lens.held_out_px * 1.05 < 0.5
    assert shown.context.draft.intrinsics_saved == frozenset()
    assert len(shown.context.draft.board_views["cam0"]) >= 10


def test_what_is_seen_is_drawn_and_what_lacks_is_asked_for(tmp_path: Path) -> None:
    shown = Shown(tmp_path, cameras=1)
    assert shown.step.view().overlays["cam0"] == ()
    shown.show(to(0, close_pictures(0)[4:5]))
    kinds = [shape.kind for shape in shown.step.view().overlays["cam0"]]
    assert "points" in kinds
    assert "polygon" in kinds
    shown.show(to(0, close_pictures(0)[:5]))
    assert shown.step.view().sentence
    assert 0.2 < shown.step.view().progress < 1.0
    assert shown.details("cam0")["views"] == 5


def test_a_board_that_moves_is_not_taken(tmp_path: Path) -> None:
    shown = Shown(tmp_path, cameras=1)
    picture = close_pictures(0)[4]
    moving = [{"cam0": np.roll(picture, 8 * i, axis=1)} for i in range(12)]
    shown.show(moving, 0.05)
    assert shown.details("cam0")["views"] == 0
    assert "still" in shown.step.view().sentence
    shown.show(moving[-1:])
    assert shown.details("cam0")["views"] == 1


def test_views_that_are_all_parallel_are_refused_and_the_step_goes_on(tmp_path: Path) -> None:
    shown = Shown(tmp_path, cameras=1)
    before = shown.context.draft
    flat = close_pictures(0, tilted=False)
    moved = [np.roll(picture, 90, axis=1) for picture in flat]
    shown.show(to(0, [*flat, *moved]))
    view = shown.step.view()
    assert view.state is StepState.FAILED
    assert "parallel to itself" in shown.told()
    assert "tilt the board" in shown.told()
    assert shown.context.draft is before
    shown.show(to(0, close_pictures(0)))
    assert shown.step.view().state is StepState.DONE
    assert shown.told() == ""


def test_a_board_of_other_dimensions_is_told_and_can_be_set(tmp_path: Path) -> None:
    shown = Shown(tmp_path, replace(SPEC, columns=7), cameras=1)
    shown.show(to(0, close_pictures(0)[:1]), 3.0)
    assert "the board has another size" in shown.told()
    assert "it fits rows of 5 squares, 7x6 was given" in shown.told()
    do(shown.step, "board", {"columns": 5})
    shown.show(to(0, close_pictures(0)[:1]))
    assert shown.told() == ""
    assert shown.details("cam0")["views"] == 1


def test_markers_of_another_dictionary_are_told(tmp_path: Path) -> None:
    shown = Shown(tmp_path, replace(SPEC, dictionary="DICT_6X6_250"), cameras=1)
    shown.show(to(0, close_pictures(0)[4:5]), 3.0)
    assert "another dictionary" in shown.told()
    assert "DICT_4X4" in shown.told()


def test_what_was_seen_of_a_wrong_board_stays_told_while_it_is_away(tmp_path: Path) -> None:
    shown = Shown(tmp_path, replace(SPEC, dictionary="DICT_6X6_250"), cameras=1)
    shown.show(to(0, close_pictures(0)[4:5]), 3.0)
    shown.show([{}], 9.0)
    assert "another dictionary" in shown.told()
    shown.show([{}], 9.0)
    assert "no board in the picture" in shown.told()


def test_a_mirrored_camera_is_told_while_the_other_sees_the_board(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    both = held_pictures()[0]
    mirrored = {"cam0": both["cam0"], "cam1": np.ascontiguousarray(both["cam1"][:, ::-1])}
    shown.show([mirrored], 4.0)
    assert shown.told() == (
        "cam1: the picture is mirrored -- switch mirroring off in the camera, then go on; if it is "
        "the mirrored back of a board printed on both sides, say so in its form above"
    )


def test_that_one_camera_does_not_see_the_board_is_no_trouble_yet(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    wall = np.random.default_rng(0).integers(0, 255, (12, 16, 3)).astype(np.uint8)
    wall = np.kron(wall, np.ones((40, 40, 1), np.uint8))
    shown.show([{"cam0": close_pictures(0)[0], "cam1": wall}], 3.0)
    assert shown.told() == ""
    shown.show([{"cam0": wall, "cam1": wall}], 4.0)
    assert "no board in the picture" in shown.told()


def test_an_inverted_board_is_noticed(tmp_path: Path) -> None:
    shown = Shown(tmp_path, cameras=1)
    inverted = [255 - picture for picture in close_pictures(0)]
    shown.show(to(0, inverted[4:5]), 3.0)
    board = shown.step.view().details["board"]
    assert isinstance(board, dict)
    assert board["inverted"]
    assert "light on dark" in str(shown.step.view().details["note"])
    shown.show(to(0, inverted[:2]))
    assert shown.details("cam0")["views"] == 3


def test_a_camera_that_stops_is_told_and_the_others_go_on(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    shown.show([held_pictures()[0]])
    shown.context.lost["cam1"] = "it was unplugged"
    for picture in close_pictures(0)[:3]:
        shown.context.drive(shown.step, {"cam0": picture}, 0.5)
    assert "cam1: the camera stopped: it was unplugged" in shown.told()
    assert shown.details("cam0")["views"] == 4
    del shown.context.lost["cam1"]
    shown.show([held_pictures()[1]])
    assert shown.told() == ""
    assert shown.details("cam1")["views"] == 2


def test_moments_of_both_cameras_are_kept_for_the_room(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    shown.show(held_pictures()[:3])
    shown.show([*to(0, close_pictures(0)), *to(1, close_pictures(1))])
    views = shown.context.draft.board_views
    assert len(views["cam0"].keys() & views["cam1"].keys()) >= 3
    for own in views.values():
        assert all(view.index == index for index, view in own.items())


def test_views_of_a_second_visit_are_not_of_the_moments_of_the_first(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    shown.show(held_pictures()[:3])
    shown.show([*to(0, close_pictures(0)), *to(1, close_pictures(1))])
    before = shown.context.draft.board_views["cam0"]
    shown.step.leave()
    shown.step = IntrinsicsStep(shown.context)
    shown.step.enter()
    do(shown.step, "use_saved", {"camera": "cam0"})
    shown.show([*held_pictures()[5:8], *to(1, close_pictures(1))])
    views = shown.context.draft.board_views
    assert views["cam0"] == before
    assert len(views["cam1"]) >= 10
    assert not views["cam0"].keys() & views["cam1"].keys()


def test_the_ruler_scales_the_board_and_keeps_the_pictures(tmp_path: Path) -> None:
    shown = Shown(tmp_path, cameras=1)
    shown.show(to(0, close_pictures(0)[:2]))
    do(shown.step, "ruler", {"mm": 97})
    board = shown.step.view().details["board"]
    assert isinstance(board, dict)
    assert (board["square_mm"], board["marker_mm"]) == (67.9, 50.44)
    shown.show(to(0, close_pictures(0)[2:]))
    assert shown.step.view().state is StepState.DONE
    assert shown.context.draft.board == replace(SPEC, square_m=0.07 * 0.97, marker_m=0.052 * 0.97)
    do(shown.step, "ruler", {"mm": 100.0 / 0.97})  # also afterwards
    found = shown.context.draft.board
    assert found is not None
    assert found.square_m == pytest.approx(0.07)


def test_another_size_of_the_board_needs_room_and_proportions_again(tmp_path: Path) -> None:
    shown = with_room(Shown(tmp_path, cameras=1))
    do(shown.step, "use_saved")
    before = shown.context.draft
    do(shown.step, "ruler", {"mm": 97})
    after = shown.context.draft
    assert None not in (before.rig, before.extrinsics_quality)
    assert (after.rig, after.extrinsics_quality, after.factors) == (None, None, None)


def test_a_new_lens_needs_the_room_again(tmp_path: Path) -> None:
    shown = with_room(Shown(tmp_path, cameras=1))
    shown.show(to(0, close_pictures(0)))
    assert shown.step.view().state is StepState.DONE
    assert shown.context.draft.rig is None
    assert shown.context.draft.factors is not None


def with_room(shown: Shown) -> Shown:
    """The same, in a setup with a lens, a room by the board, and proportions."""
    camera = RIG[0]
    lens = Intrinsics(
        camera.size_px, camera.K, camera.dist, np.ones(5, bool), 0.2, 0.2, (), (), 0.001
    )
    shown.context.draft = replace(
        shown.context.draft,
        intrinsics={camera.name: lens},
        rig=Rig((camera,)),
        extrinsics_quality=ExtrinsicsQuality("board", 0.2, {}, 0.3),
        factors=np.ones(N_FACTORS),
    )
    shown.step.leave()
    shown.step = IntrinsicsStep(shown.context)
    shown.step.enter()
    return shown


def test_without_a_board_the_one_that_is_printed_is_expected(tmp_path: Path) -> None:
    context = FakeContext(tmp_path, Draft(cameras=draft_cameras()))
    board = IntrinsicsStep(context).view().details["board"]
    usual = usual_board()
    assert isinstance(board, dict)
    assert board["columns"] == usual.columns
    assert board["square_mm"] == pytest.approx(1000 * usual.square_m)


@pytest.mark.parametrize(
    ("verb", "args", "what"),
    [
        ("board", {"columns": 2}, "at least 3 "),
        ("board", {"columns": 4.5}, "columns: expected `int"),
        ("board", {"square_mm": "wide"}, "square_mm: .* 1 to 1000 mm"),
        ("board", {"kind": "chessboard", "rows": 3}, "at least 4 "),
        ("board", {"columns": 20000, "rows": 20000}, "up to 100 squares"),
        ("board", {"square_mm": 10**400}, "out of range"),
        ("board", {"marker_mm": 90}, "smaller than the square"),
        ("board", {"kind": "dots"}, "kind: invalid enum value"),
        ("board", {"dictionary": "DICT_NONE"}, "no marker dictionary"),
        ("ruler", {"mm": 10}, "cannot be the ruler .*in millimetres"),
        ("ruler", {}, "missing required field `mm`"),
        ("use_saved", {"camera": "cam0"}, "no earlier lens"),
        ("use_saved", {"camera": "cam9"}, "no camera 'cam9'"),
        ("finish", {}, "not known well enough"),
        ("paint", {}, "no command"),
    ],
)
def test_commands_that_do_not_fit_are_refused(
    tmp_path: Path, verb: str, args: dict[str, object], what: str
) -> None:
    shown = Shown(tmp_path)
    with pytest.raises(MocapdError, match=what):
        do(shown.step, verb, args)
    board = shown.step.view().details["board"]
    assert isinstance(board, dict)
    assert board["columns"] == SPEC.columns


def test_plain_chessboards_can_be_chosen(tmp_path: Path) -> None:
    shown = Shown(tmp_path)
    do(shown.step, "board", {"kind": "chessboard", "columns": 9, "rows": 6, "square_mm": 25})
    board = shown.step.view().details["board"]
    assert isinstance(board, dict)
    assert (board["kind"], board["columns"]) == ("chessboard", 9)


def test_a_step_without_cameras_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no camera"):
        IntrinsicsStep(FakeContext(tmp_path, Draft()))


def test_the_usual_board_is_charuco() -> None:
    assert usual_board().kind is BoardKind.CHARUCO
