"""Calibrates a rig from a folder of recordings of a board: intrinsics, extrinsics, and the outliers."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from mocapd.calibrate.board.back_side import Gluing, gluing_trouble
from mocapd.calibrate.board.board_recordings import Recording, RecordingTimes, find_recordings
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
from mocapd.calibrate.extrinsics.folder_alignment import align_views
from mocapd.calibrate.extrinsics.world_frame import PlayAreaError
from mocapd.calibrate.intrinsics.intrinsics import Intrinsics, solve_intrinsics
from mocapd.calibrate.intrinsics.views import choose_views, covered_share
from mocapd.calibrate.time_alignment.instants import Instants
from mocapd.calibrate.time_alignment.time_alignment import TIME_FIX, AlignedTimes
from mocapd.calibration.board_spec import BoardSpec, corners_m
from mocapd.errors import ConfigError
from mocapd.types import Camera, Floats, Rig

# A single camera may leave its focal length open where all together then determine it.
_ALONE = 0.25  # relative standard deviation
_LENS_SIGMAS = 5.0  # of a lens in the joint solution from its separate one
_LENS_MODELS_DIFFER = 0.03  # part of the focal length that lens models differ by anyway


@dataclass(frozen=True, slots=True)
class FolderParams:
    """How much of the recordings to examine, and parameters of the extrinsics."""

    most_pictures: int = 200  # instants for the extrinsics
    densely: int = 3  # times as many are examined, for the board's motion,
    least_hz: float = 10.0  # and of long recordings so many a second
    most_views: int = 30  # of one camera, for its intrinsics
    extrinsics: BoardExtrinsicsParams = field(default_factory=BoardExtrinsicsParams)


@dataclass(frozen=True, slots=True, eq=False)
class CameraReport:
    """One camera: `fit` in the joint solution, `held_out_px` of its intrinsics; `backs` of the pictures show the board's
    back, `no_board` of them no board. `delay_frames`: how much later than the first camera it exposes pictures of one stamp,
    at first where frames are lost; `rate_hz`: of its recording, pictures counted at a usual one."""

    fit: CameraFit
    held_out_px: float
    backs: int
    pictures: int
    no_board: int
    covered: float
    delay_frames: float
    rate_hz: float
    refused_views: tuple[int, ...]


@dataclass(frozen=True, slots=True, eq=False)
class FolderCalibration:
    """The rig, its fit, and the board in the recordings; `gluing`: of a two-sided one."""

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

    Raises InputError (recordings missing or damaged) or ConfigError, which says what of the board, a camera or the
    extrinsics does not fit, and a remedy.
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
    clocks = {recording.name: recording.stamps() for recording in recordings}
    stride = _stride(recordings, clocks, params)
    for recording in recordings:
        sighting = sight_board(recording, spec, stride, progress)
        if sighting.spec != spec:
            notes.append(sighting.variant_note)
            spec = sighting.spec
        sightings.append(sighting)
    if floor_frame is not None:
        floor_frame = _examined_frame(sightings, floor_frame, stride)
    return calibrate_sightings(sightings, clocks, spec, progress, floor_frame, params, notes)


def calibrate_sightings(
    sightings: Sequence[BoardSighting],
    clocks: Mapping[str, RecordingTimes],
    spec: BoardSpec,
    progress: Progress,
    floor_frame: int | None,
    params: FolderParams,
    notes: Sequence[str] = (),
) -> FolderCalibration:
    """The rig of cameras with sightings of the board; `clocks[camera]`: times of their frames. Raises ConfigError."""
    refuse_unseen(sightings)
    board_m = corners_m(spec)
    intrinsics_of = {}
    for done, sighting in enumerate(sightings):
        progress("lenses", done, len(sightings))
        intrinsics_of[sighting.recording.name] = _solve_camera(sighting, board_m, params)
    progress("lenses", len(sightings), len(sightings))
    return _solve_rig(
        sightings, intrinsics_of, clocks, spec, floor_frame, params, list(notes), progress
    )


def _stride(
    recordings: Sequence[Recording], clocks: Mapping[str, RecordingTimes], params: FolderParams
) -> int:
    """The stride of examined frames: between neighbours the board must not go far."""
    most = params.densely * params.most_pictures
    even = -(-max(len(clocks[recording.name].stamps_s) for recording in recordings) // most)
    slowest_s = max(clock.period_s for clock in clocks.values())
    return max(1, min(even, int(1.0 / (params.least_hz * slowest_s))))


def _examined_frame(sightings: Sequence[BoardSighting], floor_frame: int, stride: int) -> int:
    """The frame, or the nearest with the board where the stride of a long recording leaves it out."""
    indices = {index for sighting in sightings for index in sighting.views}
    nearest = min(sorted(indices), key=lambda index: abs(index - floor_frame), default=floor_frame)
    return nearest if abs(nearest - floor_frame) < stride else floor_frame


def _solve_camera(one: BoardSighting, board_m: Floats, params: FolderParams) -> Intrinsics:
    size_px = one.recording.size_px
    views = choose_views(list(one.views.values()), size_px, params.most_views)
    return solve_intrinsics(views, board_m, size_px, one.recording.name, _ALONE)


def _solve_rig(
    sightings: Sequence[BoardSighting],
    intrinsics_of: Mapping[str, Intrinsics],
    clocks: Mapping[str, RecordingTimes],
    spec: BoardSpec,
    floor_frame: int | None,
    params: FolderParams,
    notes: list[str],
    progress: Progress,
) -> FolderCalibration:
    named = {sighting.recording.name: sighting for sighting in sightings}
    progress("room", 0, 1)
    views = {name: intrinsics_of[name].trusted(own.views) for name, own in named.items()}
    aligned = align_views(
        views, intrinsics_of, clocks, corners_m(spec), params.most_pictures, floor_frame
    )
    instants = aligned.instants
    floor = None if floor_frame is None else _floor_instant(instants, floor_frame)
    bundle = replace(params.extrinsics.bundle, longest_gap=aligned.longest_gap)
    extrinsics = solve_extrinsics(
        {name: replace(lens, thrown_out=()) for name, lens in intrinsics_of.items()},
        instants.views,
        spec,
        replace(params.extrinsics, bundle=bundle),
        instants.lags,
    )
    progress("room", 1, 1)
    try:
        made = place_in_world(extrinsics, floor, f"frame {floor_frame}", params.extrinsics)
        refuse_contradicted_lenses(made.rig, intrinsics_of)
    except ConfigError as error:
        raise _out_of_time(error, aligned.times) from None
    later_s = {name: fit.delay_frames * instants.period_s for name, fit in made.cameras.items()}
    notes += [f"{said}: mended" for said in aligned.times.troubles(later_s)]
    notes += [made.note] if made.note else []
    if made.gluing is not None:
        notes += [trouble] if (trouble := gluing_trouble(made.gluing)) else []
    elif spec.two_sided:
        notes.append("no camera saw the back of the board, which was said to be two-sided")
    reports = {}
    for name, sighting in named.items():
        fit = made.cameras[name]
        delay_frames = aligned.delay_frames(name, next(iter(named)), fit.delay_frames)
        rate_hz = 1.0 / clocks[name].period_s
        reports[name] = _report(sighting, intrinsics_of[name], fit, delay_frames, rate_hz)
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


def refuse_contradicted_lenses(rig: Rig, alone: Mapping[str, Intrinsics]) -> None:
    """Raises ConfigError for the camera whose focal length in the rig contradicts most its separate solution, which time
    errors cannot affect."""

    def contradiction(camera: Camera) -> float:
        own = alone[camera.name]
        off = abs(float(np.log(camera.K[0, 0] / own.K[0, 0])))
        return off / max(_LENS_MODELS_DIFFER, _LENS_SIGMAS * own.focal_deviation)

    worst = max(rig.cameras, key=contradiction)
    if contradiction(worst) <= 1.0:
        return
    own = alone[worst.name]
    raise ConfigError(
        f"its own pictures give a focal length of {own.K[0, 0]:.0f} px "
        f"(known to {100.0 * own.focal_deviation:.1f} %), all cameras together {worst.K[0, 0]:.0f} px",
        worst.name,
        "see that frames of one index are of one moment, that no camera moves while the board is shown, and that "
        "the board is as large as given",
    )


def _out_of_time(error: ConfigError, times: AlignedTimes) -> ConfigError:
    """The same, with the errors of the cameras' times that may be its cause."""
    said = "; ".join(times.troubles())
    if not said:
        return error
    return ConfigError(
        f"{said}; mended, the cameras still do not fit: {error}", "the room", TIME_FIX
    )


def _floor_instant(instants: Instants, floor_frame: int) -> int:
    """Of the picture in which the board lies on the floor. Raises ConfigError."""
    floor = instants.of_picture(floor_frame)
    if floor is None:
        available = sorted({index for own in instants.source.values() for index in own.values()})
        raise ConfigError(
            "no camera sees the board in it",
            f"--floor-frame {floor_frame}",
            f"one of the frames with the board, such as {available[len(available) // 2]}",
        )
    return floor


def _report(
    one: BoardSighting,
    intrinsics: Intrinsics,
    fit: CameraFit,
    delay_frames: float,
    rate_hz: float,
) -> CameraReport:
    return CameraReport(
        fit,
        intrinsics.held_out_px,
        sum(view.back for view in one.views.values()),
        one.pictures,
        one.pictures - len(one.views),
        covered_share(list(one.views.values()), one.recording.size_px),
        delay_frames,
        rate_hz,
        intrinsics.thrown_out,
    )
