"""From a folder of recordings of a board to a rig: lenses, room, and what was refused on the way."""

from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from mocapd.calibrate.board import BoardSpec, centre_m, corners_m
from mocapd.calibrate.bundle import Bundle, BundleParams, adjust
from mocapd.calibrate.chain import first_scene, observations
from mocapd.calibrate.detection import BoardDetector, BoardView, NotSeen, Reason, settled
from mocapd.calibrate.lens import Lens, LensLimits, solve_lens
from mocapd.calibrate.reasons import why_not_seen
from mocapd.calibrate.recordings import Recording, find_recordings
from mocapd.calibrate.reprojection import Observations, residuals_px
from mocapd.calibrate.room import (
    PlayAreaError,
    play_area_error,
    rig_in,
    world_guessed,
    world_on_floor,
)
from mocapd.calibrate.views import Choice, chosen_views, covered
from mocapd.errors import ConfigError
from mocapd.types import Bytes, Floats, Rig

Progress = Callable[[str, int, int], None]
_PROBES = 6  # pictures per camera that the board's variant is settled with
_ASKED = 2  # pictures per camera that are asked why there is no board
# A lens alone may leave its focal length open where the room then settles it.
_ALONE = LensLimits(focal_deviation=0.25)


@dataclass(frozen=True, slots=True)
class FolderParams:
    """How much of the recordings is looked at, and what the room must reach to be used."""

    most_pictures: int = 200  # per camera, evenly over the recording
    choice: Choice = field(default_factory=Choice)
    bundle: BundleParams = field(default_factory=BundleParams)
    rms_px: float = 2.5
    play_area_cm: float = 2.0
    focal_deviation: float = 0.02


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """What was found in one camera's recording: views by index, and reasons of pictures without."""

    recording: Recording
    views: Mapping[int, BoardView]
    pictures: int
    not_seen: tuple[NotSeen, ...]


@dataclass(frozen=True, slots=True, eq=False)
class CameraReport:
    """One camera: `rms_px` in the joint solution, `held_out_px` of its lens, pictures with the board."""

    rms_px: float
    held_out_px: float
    views: int
    pictures: int
    covered: float
    delay_frames: float
    focal_deviation: float
    refused_views: tuple[int, ...]
    refused_corners: int


@dataclass(frozen=True, slots=True, eq=False)
class Calibration:
    """The rig, how well it fits, and the board as it was found to be."""

    rig: Rig
    rms_px: float
    cameras: Mapping[str, CameraReport]
    positions: int
    play_area: PlayAreaError | None
    board: BoardSpec
    notes: tuple[str, ...]


def calibrate_folder(
    folder: Path,
    spec: BoardSpec,
    progress: Progress,
    floor_frame: int | None = None,
    params: FolderParams | None = None,
) -> Calibration:
    """The rig of the cameras that recorded `folder`. `floor_frame`: index at which the board lies on the floor.

    Raises InputError (recordings missing or damaged) or ConfigError: what of the board, a camera or
    the room does not fit, and what to do.
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
        sighting, found = _sighting(recording, spec, stride, progress)
        if found != spec:
            notes.append(f"{recording.name}: the board is {_difference(found)}, unlike given")
            spec = found
        sightings.append(sighting)
    _refuse_blind(sightings)
    board_m = corners_m(spec)
    lenses = {}
    for done, one in enumerate(sightings):
        progress("lenses", done, len(sightings))
        lenses[one.recording.name] = _lens(one, board_m, params)
    progress("lenses", len(sightings), len(sightings))
    return _room(sightings, lenses, spec, floor_frame, params, notes, progress)


def _sighting(
    recording: Recording, spec: BoardSpec, stride: int, progress: Progress
) -> tuple[Sighting, BoardSpec]:
    step = max(1, recording.frames // (stride * _PROBES)) * stride
    probes = [pixels for _, pixels in recording.pictures(step)][:_PROBES]
    spec = settled(spec, probes)
    detector = BoardDetector(spec)
    views: dict[int, BoardView] = {}
    blank: list[tuple[int, Bytes]] = []
    count = 0
    total = max(1, -(-recording.frames // stride))
    for index, pixels in recording.pictures(stride):
        view = detector.find(pixels, index)
        if view is not None:
            views[index] = view
        elif len(blank) < _ASKED:
            blank.append((index, pixels))
        count += 1
        progress(f"board in {recording.name}", min(count, total), total)
    reasons: tuple[NotSeen, ...] = ()
    if len(views) < _ALONE.fewest_views:
        reasons = tuple(why_not_seen(detector, pixels, index) for index, pixels in blank)
    return Sighting(recording, views, count, reasons), spec


def _difference(found: BoardSpec) -> str:
    ink = "inverted" if found.inverted else "dark on light"
    return f"{ink}, of the {'legacy' if found.legacy else 'present'} layout"


_FIX = {
    Reason.TOO_DARK: "add light, or lengthen the exposure",
    Reason.BLURRED: "focus the camera, hold the board still",
    Reason.FEW: "show the whole board, nearer",
    Reason.OTHER_SIZE: "give --board-size as columns x rows of squares",
    Reason.OTHER_DICTIONARY: "give the --dictionary that the board was printed with",
    Reason.MIRRORED: "switch mirroring off in the camera or the recorder, and record again",
    Reason.NOTHING: "show the board to this camera, or take its recording out of the folder",
}


def _refuse_blind(sightings: Sequence[Sighting]) -> None:
    """Raises ConfigError for the first camera that hardly sees the board, with the commonest reason."""
    for one in sightings:
        if len(one.views) >= _ALONE.fewest_views:
            continue
        others = [other.recording.name for other in sightings if len(other.views) > len(one.views)]
        where = str(one.recording.path)
        what = f"the board is usable in {len(one.views)} of {one.pictures} pictures"
        if others:
            what += f" (it is seen by {', '.join(others)})"
        if not one.not_seen:
            raise ConfigError(what, where, "show the board in more pictures")
        reason = Counter(told.reason for told in one.not_seen).most_common(1)[0][0]
        detail = next((told.detail for told in one.not_seen if told.reason is reason), "")
        what += f": {reason}" + (f", {detail}" if detail else "")
        raise ConfigError(what, where, _FIX[reason])


def _lens(one: Sighting, board_m: Floats, params: FolderParams) -> Lens:
    size_px = one.recording.size_px
    views = chosen_views(list(one.views.values()), size_px, params.choice)
    return solve_lens(views, board_m, size_px, one.recording.name, _ALONE)


def _room(
    sightings: Sequence[Sighting],
    lenses: Mapping[str, Lens],
    spec: BoardSpec,
    floor_frame: int | None,
    params: FolderParams,
    notes: list[str],
    progress: Progress,
) -> Calibration:
    names = [one.recording.name for one in sightings]
    sizes_px = [one.recording.size_px for one in sightings]
    board_m = corners_m(spec)
    # a view that contradicted its own lens tells nothing of the room either
    views = {
        one.recording.name: {
            index: view
            for index, view in one.views.items()
            if index not in lenses[one.recording.name].thrown_out
        }
        for one in sightings
    }
    known = sorted({index for own in views.values() for index in own})
    if floor_frame is not None and floor_frame not in known:
        raise ConfigError(
            "no camera sees the board in it",
            f"--floor-frame {floor_frame}",
            f"one of the frames with the board, such as {known[len(known) // 2]}",
        )
    progress("room", 0, 1)
    scene, indices = first_scene(names, lenses, views, board_m)
    seen = observations(names, views, indices, board_m)
    bundle = adjust(scene, indices, seen, np.array(sizes_px, dtype=float), params.bundle)
    progress("room", 1, 1)
    kept = seen.of(bundle.used)
    if floor_frame is None:
        world = world_guessed(bundle.scene, board_m)
    else:
        position = indices.index(floor_frame)
        world = world_on_floor(bundle.scene, position, centre_m(spec), f"frame {floor_frame}")
    notes += [world.note] if world.note else []
    rig = rig_in(world, bundle.scene, names, sizes_px)
    play_area = play_area_error(rig, kept)
    error_px = np.linalg.norm(residuals_px(bundle.scene, kept), axis=1)
    rms_px = _rms(error_px)
    reports = {
        one.recording.name: _report(i, one, lenses[one.recording.name], bundle, seen)
        for i, one in enumerate(sightings)
    }
    _refuse_bad(rms_px, play_area, reports, params)
    return Calibration(rig, rms_px, reports, len(indices), play_area, spec, tuple(notes))


def _rms(error_px: Floats) -> float:
    return float(np.sqrt(np.mean(error_px**2))) if len(error_px) else float("nan")


def _report(i: int, one: Sighting, lens: Lens, bundle: Bundle, seen: Observations) -> CameraReport:
    own = seen.camera == i
    kept = own & bundle.used
    error_px = np.linalg.norm(residuals_px(bundle.scene, seen.of(kept)), axis=1)
    return CameraReport(
        _rms(error_px),
        lens.held_out_px,
        len(np.unique(seen.view[kept])),
        one.pictures,
        covered(list(one.views.values()), one.recording.size_px),
        float(bundle.scene.delay[i]),
        float(bundle.focal_deviation[i]),
        lens.thrown_out,
        int((own & ~bundle.used).sum()),
    )


def _refuse_bad(
    rms_px: float,
    play_area: PlayAreaError | None,
    reports: Mapping[str, CameraReport],
    params: FolderParams,
) -> None:
    for name, report in reports.items():
        if report.focal_deviation > params.focal_deviation:
            raise ConfigError(
                f"the focal length is known to {100 * report.focal_deviation:.1f} % only",
                name,
                "show the board nearer to this camera, and tilted by 30 degrees and more",
            )
    far = play_area is not None and play_area.median_cm > params.play_area_cm
    if rms_px > params.rms_px or far:
        cm = "" if play_area is None else f", {play_area.median_cm:.1f} cm in the play area"
        raise ConfigError(
            f"the cameras contradict each other: {rms_px:.2f} px{cm}",
            "the room",
            "hold the board still at each place, keep the cameras where they are, do not mirror "
            "a picture, and see that frames of one index are of one moment",
        )
