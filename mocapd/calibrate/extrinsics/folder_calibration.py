"""From a folder of recordings of a board to a rig: intrinsics, extrinsics, and what was refused on the way."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from mocapd.calibrate.board.back_side import Gluing, gluing_trouble
from mocapd.calibrate.board.recordings import find_recordings
from mocapd.calibrate.extrinsics.board_extrinsics import (
    BoardExtrinsicsParams,
    CameraFit,
    place_in_world,
    solve_extrinsics,
)
from mocapd.calibrate.extrinsics.board_sighting import (
    BoardSighting,
    Progress,
    refuse_unseen,
    sight_board,
)
from mocapd.calibrate.extrinsics.world_frame import PlayAreaError
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics, IntrinsicsLimits, solve_intrinsics
from mocapd.calibrate.intrinsics.views import Choice, choose_views, covered
from mocapd.calibration.board_spec import BoardSpec, corners_m
from mocapd.errors import ConfigError
from mocapd.types import Floats, Rig

# One camera alone may leave its focal length open where all together then settle it.
_ALONE = IntrinsicsLimits(focal_deviation=0.25)


@dataclass(frozen=True, slots=True)
class FolderParams:
    """How much of the recordings is looked at, and how the extrinsics are solved."""

    most_pictures: int = 200  # per camera, evenly over the recording
    choice: Choice = field(default_factory=Choice)
    extrinsics: BoardExtrinsicsParams = field(default_factory=BoardExtrinsicsParams)


@dataclass(frozen=True, slots=True, eq=False)
class CameraReport:
    """One camera: `rms_px` in the joint solution, `held_out_px` of its intrinsics, pictures with the board,
    `backs` of them with its back."""

    rms_px: float
    held_out_px: float
    views: int
    backs: int
    pictures: int
    covered: float
    delay_frames: float
    focal_deviation: float
    refused_views: tuple[int, ...]
    refused_corners: int


@dataclass(frozen=True, slots=True, eq=False)
class FolderCalibration:
    """The rig, how well it fits, and the board as it was found to be; `gluing`: of a two-sided one."""

    rig: Rig
    rms_px: float
    cameras: Mapping[str, CameraReport]
    positions: int
    play_area: PlayAreaError | None
    board: BoardSpec
    gluing: Gluing | None
    notes: tuple[str, ...]


def calibrate_folder(
    folder: Path,
    spec: BoardSpec,
    progress: Progress,
    floor_frame: int | None = None,
    params: FolderParams | None = None,
) -> FolderCalibration:
    """The rig of the cameras that recorded `folder`. `floor_frame`: index at which the board lies on the floor.

    Raises InputError (recordings missing or damaged) or ConfigError: what of the board, a camera or
    the extrinsics do not fit, and what to do.
    """
    params = params or FolderParams()
    recordings = find_recordings(folder)
    if len(recordings) > 1 and not spec.turns_show:
        raise ConfigError(
            f"a chessboard of {spec.columns}x{spec.rows} squares looks the same upside down",
            "the board",
            "for several cameras take one with an even and an odd number of squares, or ChArUco",
        )
    notes: list[str] = []
    sightings = []
    stride = max(1, -(-max(one.frames for one in recordings) // params.most_pictures))
    for recording in recordings:
        sighting = sight_board(recording, spec, stride, progress)
        if sighting.spec != spec:
            notes.append(sighting.variant_note)
            spec = sighting.spec
        sightings.append(sighting)
    refuse_unseen(sightings)
    board_m = corners_m(spec)
    intrinsics_of = {}
    for done, one in enumerate(sightings):
        progress("lenses", done, len(sightings))
        intrinsics_of[one.recording.name] = _solve_camera(one, board_m, params)
    progress("lenses", len(sightings), len(sightings))
    return _solve_rig(sightings, intrinsics_of, spec, floor_frame, params, notes, progress)


def _solve_camera(one: BoardSighting, board_m: Floats, params: FolderParams) -> Intrinsics:
    size_px = one.recording.size_px
    views = choose_views(list(one.views.values()), size_px, params.choice)
    return solve_intrinsics(views, board_m, size_px, one.recording.name, _ALONE)


def _solve_rig(
    sightings: Sequence[BoardSighting],
    intrinsics_of: Mapping[str, Intrinsics],
    spec: BoardSpec,
    floor_frame: int | None,
    params: FolderParams,
    notes: list[str],
    progress: Progress,
) -> FolderCalibration:
    names = [one.recording.name for one in sightings]
    views = {one.recording.name: one.views for one in sightings}
    known = sorted(
        {i for name in names for i in views[name] if i not in intrinsics_of[name].thrown_out}
    )
    if floor_frame is not None and floor_frame not in known:
        raise ConfigError(
            "no camera sees the board in it",
            f"--floor-frame {floor_frame}",
            f"one of the frames with the board, such as {known[len(known) // 2]}",
        )
    progress("room", 0, 1)
    sizes_px = [one.recording.size_px for one in sightings]
    extrinsics = solve_extrinsics(names, sizes_px, intrinsics_of, views, spec, params.extrinsics)
    progress("room", 1, 1)
    made = place_in_world(extrinsics, floor_frame, f"frame {floor_frame}", params.extrinsics)
    notes += [made.note] if made.note else []
    if made.gluing is not None:
        notes += [trouble] if (trouble := gluing_trouble(made.gluing)) else []
    elif spec.two_sided:
        notes.append("no camera saw the back of the board, which was said to be two-sided")
    reports = {
        one.recording.name: _report(
            one, intrinsics_of[one.recording.name], made.cameras[one.recording.name]
        )
        for one in sightings
    }
    return FolderCalibration(
        made.rig,
        made.rms_px,
        reports,
        made.positions,
        made.play_area,
        spec,
        made.gluing,
        tuple(notes),
    )


def _report(one: BoardSighting, intrinsics: Intrinsics, fit: CameraFit) -> CameraReport:
    return CameraReport(
        fit.rms_px,
        intrinsics.held_out_px,
        fit.views,
        sum(view.back for view in one.views.values()),
        one.pictures,
        covered(list(one.views.values()), one.recording.size_px),
        fit.delay_frames,
        fit.focal_deviation,
        intrinsics.thrown_out,
        fit.refused_corners,
    )
