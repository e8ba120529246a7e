"""Solves the extrinsics from board positions that several cameras see, and rates their fit."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
import scipy  # its submodules load on first use: they take long to import

from mocapd.calibrate.board.back_side import OFFSET, Gluing, gluing_of, usual_back
from mocapd.calibrate.board.board_detection import BoardView
from mocapd.calibrate.extrinsics.board_reprojection import (
    POSE,
    Observations,
    ReprojectionProblem,
    placed_m,
    residuals_px,
    with_steps,
)
from mocapd.calibrate.extrinsics.bundle_adjustment import Bundle, BundleParams, adjust_bundle
from mocapd.calibrate.extrinsics.contradictions import contradiction, mirrored_error
from mocapd.calibrate.extrinsics.mirrored_pictures import PrintPose, suspect
from mocapd.calibrate.extrinsics.pose_graph import (
    board_poses,
    camera_from_board,
    initial_scene,
    observations,
)
from mocapd.calibrate.extrinsics.world_frame import (
    PlayAreaError,
    guess_world,
    play_area_error,
    rig_in_world,
    world_on_floor,
)
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics, board_pose, larger_than_hd
from mocapd.calibration.board_spec import BoardSpec, centre_m, corners_m
from mocapd.errors import ConfigError
from mocapd.geometry.reprojection import INTRINSICS, camera_matrix, intrinsics_row
from mocapd.geometry.rigid_transforms import IDENTITY, RigidTransform, concatenate, stack
from mocapd.types import Floats, Rig

_GUESSED = (
    "no floor was given: up is guessed from the cameras, the floor is put under the lowest "
    "place of the board; give the frame in which the board lies on the floor (--floor-frame)"
)
_NINE_IN_TEN = 1.645  # standard deviations, of one direction, which mostly outweighs the others


@dataclass(frozen=True, slots=True)
class BoardExtrinsicsParams:
    """Parameters of the solution, and requirements for using it; rms_px: of pictures up to 1280 px wide, in larger ones in
    proportion."""

    bundle: BundleParams = field(default_factory=BundleParams)
    rms_px: float = 2.5
    play_area_cm: float = 2.0
    place_cm: float = 10.0
    focal_deviation: float = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class SceneExtrinsics:
    """Cameras and board positions in the first camera's frame; `indices`: of the positions."""

    names: tuple[str, ...]
    sizes_px: tuple[tuple[int, int], ...]
    spec: BoardSpec
    indices: tuple[int, ...]
    obs: Observations
    bundle: Bundle


@dataclass(frozen=True, slots=True)
class CameraFit:
    """One camera in the joint solution: error, number of its pictures, delay relative to the first camera; `place_cm`:
    bound of the error of its position relative to the first, in nine of ten cases."""

    rms_px: float
    views: int
    delay_frames: float
    focal_deviation: float
    place_cm: float
    refused_corners: int


@dataclass(frozen=True, slots=True, eq=False)
class WorldExtrinsics:
    """The extrinsics in the world; `note`: a remark on the floor for the user, perhaps ""; `gluing`: of a two-sided board,
    None without views of its back."""

    rig: Rig
    rms_px: float
    cameras: Mapping[str, CameraFit]
    positions: int
    play_area: PlayAreaError | None
    note: str
    gluing: Gluing | None


def solve_extrinsics(
    intrinsics_of: Mapping[str, Intrinsics],
    views: Mapping[str, Mapping[int, BoardView]],
    spec: BoardSpec,
    params: BoardExtrinsicsParams,
    lags: Mapping[str, Mapping[int, float]] | None = None,
) -> SceneExtrinsics:
    """Solves all cameras of `intrinsics_of`, in its order, and positions at once; `views[camera][index]`, simultaneous for
    one index, or `lags[camera][index]` [frames] after it.

    Raises ConfigError naming cameras without positions in common with the others, MirroredError naming
    mirrored pictures.
    """
    board_m, names = corners_m(spec), tuple(intrinsics_of)
    sizes_px = tuple(lens.size_px for lens in intrinsics_of.values())
    trusted = {name: intrinsics_of[name].trusted(views[name]) for name in names}
    if spec.two_sided:
        poses = {name: board_poses(trusted[name], intrinsics_of[name], board_m) for name in names}
        suspicion = suspect(names, poses, board_m)
        if suspicion is not None:
            raise mirrored_error(suspicion)
    scene, indices = initial_scene(names, intrinsics_of, trusted, board_m, params.bundle.gluing)
    obs = observations(names, trusted, indices, board_m, lags)
    bundle = adjust_bundle(scene, indices, obs, np.array(sizes_px, dtype=float), params.bundle)
    return SceneExtrinsics(names, sizes_px, spec, tuple(indices), obs, bundle)


def lone_camera(
    name: str, size_px: tuple[int, int], intrinsics: Intrinsics, spec: BoardSpec
) -> SceneExtrinsics:
    """One camera without a board; `with_board` then adds a position that places it."""
    none = np.zeros(0, np.int64)
    scene = ReprojectionProblem(
        intrinsics_row(intrinsics.K, intrinsics.dist)[None],
        stack([IDENTITY]),
        stack([]),
        np.zeros(1),
        np.zeros((0, 2, POSE)),
        usual_back(corners_m(spec)),
    )
    obs = Observations(
        none, none, np.zeros((0, 3)), np.zeros((0, 2)), np.zeros(0, bool), np.zeros(0)
    )
    bundle = Bundle(
        scene, np.zeros(0, bool), np.array([intrinsics.focal_deviation]), np.zeros(1), None
    )
    return SceneExtrinsics((name,), (size_px,), spec, (), obs, bundle)


def with_board(
    extrinsics: SceneExtrinsics, index: int, views: Mapping[str, BoardView]
) -> SceneExtrinsics:
    """The same with one more position of the board; the cameras stay."""
    board_m, scene = corners_m(extrinsics.spec), extrinsics.bundle.scene
    placed = {n: {index: views[n]} if n in views else {} for n in extrinsics.names}
    obs = observations(extrinsics.names, placed, [index], board_m)
    best, best_px = None, np.inf
    for name, view in views.items():
        i = extrinsics.names.index(name)
        row = scene.intrinsics[i]
        pose = board_pose(view, board_m, camera_matrix(row), row[4:])
        if pose is None:
            continue
        held = camera_from_board(PrintPose(pose, view.back), scene.back)
        guess = _with(scene, scene.camera_from_scene[i].inverse() @ held)
        fitted, error_px = _fit_position(guess, obs)
        # a single camera may choose the mirrored pose of a board that is small in the picture
        if error_px < best_px:
            best, best_px = fitted, error_px
    if best is None:
        raise ConfigError("the board cannot be placed", "the room", "show more of the board")
    scene = replace(
        scene,
        scene_from_board=concatenate(scene.scene_from_board, best.scene_from_board),
        path=np.concatenate([scene.path, best.path]),
    )
    here = replace(obs, view=np.full_like(obs.view, len(extrinsics.indices)))
    merged = extrinsics.obs.with_others(here)
    used = np.concatenate([extrinsics.bundle.used, np.ones(len(obs.camera), bool)])
    bundle = replace(extrinsics.bundle, scene=scene, used=used)
    return replace(extrinsics, indices=(*extrinsics.indices, index), obs=merged, bundle=bundle)


def _with(scene: ReprojectionProblem, scene_from_board: RigidTransform) -> ReprojectionProblem:
    """The same cameras and this position alone."""
    return replace(
        scene,
        scene_from_board=stack([scene_from_board]),
        delay=np.zeros(len(scene.delay)),
        path=np.zeros((1, 2, POSE)),
    )


def _fit_position(
    scene: ReprojectionProblem, obs: Observations
) -> tuple[ReprojectionProblem, float]:
    """The fit of the single position, and the root mean square error [px]."""
    cameras = len(scene.delay)
    still = np.zeros((cameras, INTRINSICS)), np.zeros((cameras, POSE))

    def at_step(x: Floats) -> ReprojectionProblem:
        return with_steps(scene, *still, x[None], np.zeros(cameras), np.zeros(OFFSET))

    solution = scipy.optimize.least_squares(
        lambda x: residuals_px(at_step(x), obs).ravel(), np.zeros(POSE), x_scale=0.01
    )
    fitted = at_step(solution.x)
    return fitted, _rms(np.linalg.norm(residuals_px(fitted, obs), axis=1))


def place_in_world(
    extrinsics: SceneExtrinsics, floor: int | None, where: str, params: BoardExtrinsicsParams
) -> WorldExtrinsics:
    """The extrinsics in the world of the board that lies on the floor at index `floor`; None: a guess.

    `where` names that picture in an error. Raises ContradictionError, or ConfigError for an inaccurate focal
    length, or cameras under the floor.
    """
    scene, obs = extrinsics.bundle.scene, extrinsics.obs
    if floor is None:
        world = guess_world(scene, corners_m(extrinsics.spec))
    else:
        spec = extrinsics.spec
        position = extrinsics.indices.index(floor)
        world = world_on_floor(scene, position, centre_m(spec), where, spec.two_sided)
    rig = rig_in_world(world, scene, extrinsics.names, extrinsics.sizes_px)
    inliers = obs.of(extrinsics.bundle.used)
    deviation = extrinsics.bundle.back_deviation
    cameras = {name: _camera_fit(extrinsics, i) for i, name in enumerate(extrinsics.names)}
    area = play_area_error(rig, _as_placed(scene, inliers))
    place_cm = max(fit.place_cm for fit in cameras.values())
    made = WorldExtrinsics(
        rig,
        _rms(np.linalg.norm(residuals_px(scene, inliers), axis=1)),
        cameras,
        len(extrinsics.indices),
        None if area is None else area.with_places(place_cm),
        _GUESSED if floor is None else "",
        None if deviation is None else gluing_of(scene.back, deviation),
    )
    _refuse_bad(made, area, params, extrinsics.spec)
    return made


def _as_placed(scene: ReprojectionProblem, obs: Observations) -> Observations:
    """Observations with corners on the back at their true place; rounded, so that one corner has one place."""
    if not obs.on_back.any():
        return obs
    return replace(obs, point_m=np.round(placed_m(scene, obs), 9))


def _rms(error_px: Floats) -> float:
    return float(np.sqrt(np.mean(error_px**2))) if len(error_px) else float("nan")


def _camera_fit(extrinsics: SceneExtrinsics, i: int) -> CameraFit:
    bundle, obs = extrinsics.bundle, extrinsics.obs
    own = obs.camera == i
    inliers = own & bundle.used
    return CameraFit(
        _rms(np.linalg.norm(residuals_px(bundle.scene, obs.of(inliers)), axis=1)),
        len(np.unique(obs.view[inliers])),
        float(bundle.scene.delay[i]),
        float(bundle.focal_deviation[i]),
        100.0 * _NINE_IN_TEN * float(bundle.place_deviation_m[i]),
        int((own & ~bundle.used).sum()),
    )


def _refuse_bad(
    made: WorldExtrinsics,
    area: PlayAreaError | None,
    params: BoardExtrinsicsParams,
    spec: BoardSpec,
) -> None:
    """`area`: without the uncertainty of the cameras' positions."""
    far = area is not None and area.median_cm > params.play_area_cm
    larger = max(larger_than_hd(camera.size_px) for camera in made.rig.cameras)
    if made.rms_px > larger * params.rms_px or far:
        raise contradiction(made.rms_px, area, spec.two_sided)
    for name, fit in made.cameras.items():
        if fit.focal_deviation > params.focal_deviation:
            raise ConfigError(
                f"the focal length is known to {100 * fit.focal_deviation:.1f} % only",
                name,
                "show the board nearer to this camera, and tilted by 30 degrees and more",
            )
        if fit.place_cm > params.place_cm:
            raise ConfigError(
                f"where it stands is known to {fit.place_cm:.0f} cm only",
                name,
                "show the board at more places where this camera and others see it, and hold it still there",
            )
