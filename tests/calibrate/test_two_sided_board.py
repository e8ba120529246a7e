"""Cameras all around a board that is printed on both sides: found from either side, and what is wrong named."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from mocapd.calibrate.board.back_side import BackPrint, GluingPrior, gluing_trouble
from mocapd.calibrate.board.board_detection import BoardDetector, BoardView, Reason
from mocapd.calibrate.board.detection_diagnostics import diagnose_detection
from mocapd.calibrate.extrinsics.board_extrinsics import (
    BoardExtrinsicsParams,
    WorldExtrinsics,
    place_in_world,
    solve_extrinsics,
)
from mocapd.calibrate.extrinsics.bundle_adjustment import BundleParams
from mocapd.calibrate.extrinsics.contradictions import ContradictionError, MirroredError
from mocapd.calibrate.extrinsics.folder_calibration import (
    FolderCalibration,
    FolderParams,
    calibrate_folder,
)
from mocapd.calibrate.intrinsics.intrinsics import solve_intrinsics
from mocapd.calibration.board_spec import BoardKind, BoardSpec, corners_m
from mocapd.errors import ConfigError
from mocapd.sim.board.board_picture import BoardFilm, PrintedBoard
from mocapd.types import Bytes
from tests.calibrate.seen_once import seen_once
from tests.calibrate.two_sided_scene import (
    PRINT,
    SPEC,
    cameras_around,
    hidden_from,
    lying,
    mirrored,
    off_m,
    true_lenses,
    turned_poses,
    view_of,
    views_of,
)

RIG = cameras_around()
NAMES = tuple(camera.name for camera in RIG)
HELD = 32
POSES = [*turned_poses(HELD), lying()]
SHOWN = 20  # of them to the detector
ASKEW = replace(PRINT, back_shift_m=(0.006, -0.002), back_turn_rad=0.03)


@pytest.fixture(scope="module", autouse=True)
def boards_seen_once() -> Iterator[None]:
    """Several tests look at the same pictures."""
    with seen_once():
        yield


def quiet(what: str, done: int, total: int) -> None:
    """Progress that nobody looks at."""


def solved(
    views: dict[str, dict[int, BoardView]],
    spec: BoardSpec = SPEC,
    floor: int | None = HELD,
    gluing: GluingPrior | None = None,
    place_cm: float = 10.0,
) -> WorldExtrinsics:
    bundle = BundleParams(gluing=gluing or GluingPrior())
    params = BoardExtrinsicsParams(bundle=bundle, place_cm=place_cm)
    found = solve_extrinsics(true_lenses(RIG), views, spec, params)
    return place_in_world(found, floor, "the floor", params)


def write_pictures(folder: Path, board: PrintedBoard = PRINT) -> Path:
    """A folder of pictures per camera; the wearer stands before one camera at each position."""
    for c, camera in enumerate(RIG):
        film = BoardFilm(camera, board)
        wearer = np.full((camera.size_px[1], camera.size_px[0], 3), 110, np.uint8)
        (folder / camera.name).mkdir(parents=True)
        for i, pose in enumerate([*POSES[:SHOWN], lying()]):
            hidden = c == hidden_from(i)
            picture = wearer if hidden else film.picture(*pose, seed=100 * c + i)
            cv2.imwrite(str(folder / camera.name / f"{i:04d}.bmp"), picture)
    return folder


@pytest.fixture(scope="module")
def pictures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_pictures(tmp_path_factory.mktemp("around") / "held")


@pytest.fixture(scope="module")
def calibrated(pictures: Path) -> FolderCalibration:
    return calibrate_folder(pictures, SPEC, quiet, floor_frame=SHOWN)


def test_four_cameras_around_the_wearer_are_found(calibrated: FolderCalibration) -> None:
    """No position of the board is seen by all four, and opposite cameras see its two sides."""
    error_m, scale = off_m(RIG, calibrated.rig)
    for name, off in zip(NAMES, error_m, strict=True):
        one = calibrated.cameras[name]
        print(f"{name}: {100 * off:.3f} cm off, {one.backs} backs in {one.fit.views} views")
        assert 0 < one.backs < one.fit.views
    print(
        f"scale: {100 * scale:+.3f} %, {calibrated.positions} positions, {calibrated.rms_px:.2f} px"
    )
    print(f"the back lies {calibrated.gluing}")
    assert error_m.max() <= 0.01
    assert abs(scale) <= 0.005
    assert calibrated.board.two_sided
    assert calibrated.notes == ()


def test_how_the_back_was_glued_is_measured(calibrated: FolderCalibration) -> None:
    gluing = calibrated.gluing
    assert gluing is not None
    assert gluing.right_mm == pytest.approx(1.2, abs=0.5)
    assert gluing.down_mm == pytest.approx(-0.8, abs=0.5)
    assert gluing.clockwise_deg == pytest.approx(np.degrees(0.004), abs=0.15)
    assert gluing.thickness_mm == pytest.approx(5.0, abs=1.0)


def test_without_being_told_of_the_back_the_camera_that_sees_it_is_refused(
    pictures: Path, tmp_path: Path
) -> None:
    """A board of one side that is mirrored is a mirrored picture, as ever."""
    spec = replace(SPEC, two_sided=False)
    views = BoardDetector(SPEC), BoardDetector(spec)
    for path in sorted((pictures / "cam0").iterdir()):
        pixels = cv2.imread(str(path))
        assert pixels is not None
        picture = pixels.astype(np.uint8)
        both, front = (detector.find(picture) for detector in views)
        assert (front is not None) == (both is not None and not both.back)
        if both is not None and both.back:
            (tmp_path / "cam0").mkdir(exist_ok=True)
            (tmp_path / "cam0" / path.name).symlink_to(path)
    with pytest.raises(ConfigError, match=r"the picture is mirrored -- .* give --two-sided"):
        calibrate_folder(tmp_path, spec, quiet)


def picture_of_back(board: PrintedBoard = PRINT) -> tuple[Bytes, BoardView]:
    """A picture in which the back is seen, and what is to be found in it."""
    for i, pose in enumerate(POSES):
        view = view_of(RIG[0], pose, i, board, noise_px=0.0)
        if view is not None and view.back:
            return BoardFilm(RIG[0], board).picture(*pose), view
    raise AssertionError("no pose shows the back")


@pytest.mark.parametrize("inverted", [False, True])
def test_the_back_is_found_where_it_is(inverted: bool) -> None:
    picture, expected = picture_of_back(replace(ASKEW, inverted=inverted))
    view = BoardDetector(replace(SPEC, inverted=inverted)).find(picture)
    assert view is not None
    assert view.back
    assert len(view.ids) >= 15
    off_px = np.linalg.norm(view.corners_px - expected.corners_px[view.ids], axis=1)
    assert off_px.max() < 0.35


def test_why_there_is_no_board_is_told_of_a_back_too() -> None:
    picture, _ = picture_of_back()
    told = diagnose_detection(BoardDetector(replace(SPEC, columns=6)), picture)
    assert told.reason is Reason.OTHER_SIZE
    assert "rows of 5" in told.detail


def test_a_plain_chessboard_has_no_back() -> None:
    with pytest.raises(ConfigError, match="the same from both sides"):
        BoardSpec(BoardKind.CHESSBOARD, 5, 6, 0.07, two_sided=True)


def test_a_lens_is_found_from_both_sides() -> None:
    camera = RIG[0]
    poses = turned_poses(40, seed=9)
    views = [view for i, pose in enumerate(poses) if (view := view_of(camera, pose, i)) is not None]
    assert len({view.back for view in views}) == 2
    lens = solve_intrinsics(views, corners_m(SPEC), camera.size_px, camera.name)
    assert abs(lens.K[0, 0] / camera.K[0, 0] - 1.0) < 0.01


def test_corners_of_the_back_move_as_their_slopes_say() -> None:
    points_m = corners_m(SPEC)
    back = BackPrint(points_m.mean(axis=0), np.array([0.003, -0.002, 0.3, 0.004]))
    step = np.array([1e-6, -2e-6, 3e-6, 1e-6])
    ahead, behind = (back.with_step(s * step).board_from_back.apply(points_m) for s in (1.0, -1.0))
    np.testing.assert_allclose((ahead - behind) / 2.0, back.slopes(points_m) @ step, atol=1e-12)


def test_a_back_that_is_glued_askew_is_told_in_millimetres_and_does_no_harm() -> None:
    found = solved(views_of(RIG, POSES, ASKEW))
    assert found.gluing is not None
    told = gluing_trouble(found.gluing)
    print(told)
    assert "to the right and 2." in told
    assert "mm above" in told
    assert "turned by 1.7 degrees clockwise" in told
    error_m, scale = off_m(RIG, found.rig)
    assert error_m.max() <= 0.01
    assert abs(scale) <= 0.005


@pytest.mark.parametrize(
    ("thickness_m", "askew"), [(0.0, True), (0.005, False), (0.005, True), (0.01, True)]
)
def test_the_back_is_measured_since_a_thickness_or_gluing_taken_for_granted_costs_centimetres(
    thickness_m: float, askew: bool
) -> None:
    board = replace(PRINT, thickness_m=thickness_m)
    if not askew:
        board = replace(board, back_shift_m=(0.0, 0.0), back_turn_rad=0.0)
    views = views_of(RIG, POSES, board)
    off_cm = {}
    ways = {"measured": None, "thickness known": thickness_m}
    if thickness_m > 0.0:
        ways["taken as 0"] = 0.0
    for how, mean_m in ways.items():
        known = None if mean_m is None else GluingPrior((0.0, 0.0, 0.0, mean_m), (1e-7,) * 4)
        # what is taken for granted wrongly is refused otherwise
        error_m, scale = off_m(RIG, solved(views, gluing=known, place_cm=100.0).rig)
        off_cm[how] = 100.0 * error_m.max()
        glued = "1.4 mm askew" if askew else "in register"
        told = f"{1000 * thickness_m:g} mm, {glued}, {how}"
        print(f"{told}: within {off_cm[how]:.2f} cm, scale {100 * scale:+.2f} %")
    assert off_cm["measured"] < 0.5
    assert off_cm["measured"] < off_cm["thickness known"] + 0.05
    if thickness_m > 0.0:
        assert off_cm["taken as 0"] > 1.5


def test_a_back_that_little_ties_to_the_front_is_called_so() -> None:
    """Two cameras face each other, three positions of the board between them, always the same side to each."""
    rig = (RIG[0], RIG[2])
    both = ((view_of(rig[0], pose, i), view_of(rig[1], pose, i)) for i, pose in enumerate(POSES))
    shared = [(a, b) for a, b in both if a and b and b.back][:3]
    views = {"cam0": {a.index: a for a, _ in shared}, "cam2": {b.index: b for _, b in shared}}
    params = BoardExtrinsicsParams()
    found = solve_extrinsics(true_lenses(rig), views, SPEC, params)
    made = place_in_world(found, None, "", params)
    assert made.gluing is not None
    assert "mm only" in gluing_trouble(made.gluing)


@pytest.mark.parametrize("which", ["cam0", "cam2"])
def test_the_camera_whose_picture_is_mirrored_is_named(which: str) -> None:
    views = views_of(RIG, POSES)
    views[which] = mirrored(views[which])
    with pytest.raises(MirroredError, match=rf"^{which}: the pictures are mirrored"):
        solved(views)


def test_of_two_against_two_both_are_named() -> None:
    views = views_of(RIG, POSES)
    for name in ("cam0", "cam3"):
        views[name] = mirrored(views[name])
    with pytest.raises(MirroredError, match="or else those of") as refused:
        solved(views)
    assert all(name in str(refused.value) for name in NAMES)


def test_a_back_glued_on_upside_down_is_named() -> None:
    with pytest.raises(MirroredError, match="the board: the back is upside down"):
        solved(views_of(RIG, POSES, replace(PRINT, back_turn_rad=np.pi + 0.01)))


def test_pictures_that_are_all_mirrored_show_on_the_floor() -> None:
    views = {name: mirrored(own) for name, own in views_of(RIG, POSES).items()}
    with pytest.raises(ConfigError, match="its back is up, or all pictures are mirrored"):
        solved(views)


def test_a_board_with_two_fronts_is_refused() -> None:
    """The first page was glued on twice: from behind it shows no mirrored markers."""
    rig_views = views_of(RIG, POSES[:12])
    views = {
        name: {
            i: replace(view, back=False, corners_px=_other_front(view)) if view.back else view
            for i, view in own.items()
        }
        for name, own in rig_views.items()
    }
    with pytest.raises(ContradictionError, match="the back of the board must be the second page"):
        solved(views, floor=None)


def _other_front(view: BoardView) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Corner ids of a second front behind the first: along each row from the other end."""
    columns, rows = SPEC.grid
    return view.corners_px.reshape(rows, columns, 2)[:, ::-1].reshape(-1, 2)


def test_one_side_alone_does_not_reach_all_around() -> None:
    views = {
        name: {i: view for i, view in own.items() if not view.back}
        for name, own in views_of(RIG, POSES).items()
    }
    with pytest.raises(ConfigError, match="never sees the board at the same moment as another"):
        solved(views, replace(SPEC, two_sided=False))


def test_a_real_camera_that_is_mirrored_is_named(shared_dir: Path, tmp_path: Path) -> None:
    """Three real webcams and a board in a hand, the pictures of one of them turned round."""
    folder = shared_dir / "realvideo" / "caliscope_charuco"
    if not folder.is_dir():
        pytest.skip("../shared is not beside this checkout: realvideo/caliscope_charuco is missing")
    for video in sorted(folder.glob("*.mp4"))[:3]:
        target = tmp_path / video.stem
        target.mkdir()
        stream = cv2.VideoCapture(str(video))
        for i in range(57):
            read, pixels = stream.read()
            if read and i % 4 == 0:
                shown = pixels[:, ::-1] if video.stem == "cam_2" else pixels
                cv2.imwrite(str(target / f"{i:04d}.jpg"), shown)
    board = BoardSpec(BoardKind.CHARUCO, 4, 5, 0.054, 0.0405, inverted=True, two_sided=True)
    with pytest.raises(MirroredError, match=r"^cam_2: the pictures are mirrored"):
        calibrate_folder(tmp_path, board, quiet, params=FolderParams(most_views=8))
