"""How well the wearer alone tells where the cameras stand, on captures whose rig is known.

`python -m lab.extrinsics_from_body [--rms] CAPTURE...`: of the rig only the lenses are given. With
--rms the capture is tracked with both rigs, which takes a minute more.
"""

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from mocapd.body.shape import mean_shape
from mocapd.calibrate.self_calibration.joint_solver import SelfCalibrationReport
from mocapd.calibrate.self_calibration.patch_tracks import PatchTracks
from mocapd.calibrate.self_calibration.relative_pose import relative_pose
from mocapd.calibrate.self_calibration.self_calibration import extrinsics_from_body
from mocapd.calibration.calibration_record import ShirtColours
from mocapd.calibration.from_origin import from_capture
from mocapd.capture.capture_folder import CaptureFolder, frame_sets, load_folder
from mocapd.config.sections import TrackerSection, default_cache_dir
from mocapd.evaluate.score import JOINT_SETS, match, score
from mocapd.evaluate.truth import Truth, load_truth
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import camera_from_world, with_extrinsics
from mocapd.geometry.rigid_transforms import RigidTransform
from mocapd.session.offline import RecordedTrack, track_all
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.colour.from_pictures import colour_model, white_balances
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.shirt.pose_database.database_file import load_or_build
from mocapd.tracking.body_tracker import BodyTracker
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue
from mocapd.types import Camera, Floats, Rig


@dataclass(frozen=True, slots=True)
class ExtrinsicsScore:
    """By camera but the first: rotation_deg and distance_percent against the first camera."""

    rotation_deg: dict[str, float]
    distance_percent: dict[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class _CaptureKnowledge:
    """What a capture tells of wearer and colours."""

    folder: CaptureFolder
    stature_m: float
    colours: ColourModel
    W: dict[str, Floats]


def score_extrinsics(found: Rig, true: Rig) -> ExtrinsicsScore:
    """Where every camera stands from the first, against the truth."""
    rotation, distance = {}, {}
    for one, wanted in zip(found.cameras[1:], true.cameras[1:], strict=True):
        mine, theirs = _relative(found.cameras[0], one), _relative(true.cameras[0], wanted)
        angle_rad = rotations.angle_rad(
            rotations.from_matrix(mine.R), rotations.from_matrix(theirs.R)
        )
        rotation[one.name] = float(np.degrees(angle_rad))
        length = float(np.linalg.norm(mine.t_m) / np.linalg.norm(theirs.t_m))
        distance[one.name] = 100.0 * (length - 1.0)
    return ExtrinsicsScore(rotation, distance)


def beside_first(found: Rig, true: Rig) -> Rig:
    """The rig that was found, moved so that its first camera is where it truly stands."""
    first = true.cameras[0]
    out = [first]
    for one in found.cameras[1:]:
        one_from_first = _relative(found.cameras[0], one)
        out.append(with_extrinsics(one, one_from_first @ camera_from_world(first)))
    return Rig(tuple(out))


def _relative(first: Camera, second: Camera) -> RigidTransform:
    """second_from_first."""
    return camera_from_world(second) @ camera_from_world(first).inverse()


def _known(capture: Path) -> _CaptureKnowledge:
    folder = load_folder(capture)
    shirt = from_capture(folder).shirt or ShirtColours()
    colours = colour_model(shirt.model)
    W = white_balances(shirt.white_balance, colours)
    return _CaptureKnowledge(folder, folder.stature_m or TrackerSection().stature_m, colours, W)


def find_extrinsics(
    known: _CaptureKnowledge, database: PoseDatabase
) -> tuple[Rig, SelfCalibrationReport]:
    """The rig from the capture's lenses and videos."""
    bare_cameras = known.folder.rig.cameras
    tracks = PatchTracks(bare_cameras, known.stature_m, known.colours, known.W, database)
    for frames in frame_sets(known.folder):
        tracks.add(frames)
    return extrinsics_from_body(tracks.observations, bare_cameras, known.stature_m)


def rms_cm(known: _CaptureKnowledge, rig: Rig, database: PoseDatabase) -> tuple[float, float]:
    """Of the upper body's joints, tracked with this rig: as it is, and once the whole track is moved
    rigidly onto the truth, because a room without a board has a world of its own."""
    shirt = ShirtCue(rig, known.stature_m, known.colours, known.W, database)
    tracker = BodyTracker("shirt", rig, known.stature_m, shirt, clothes=None)
    track = track_all(
        tracker, mean_shape(known.stature_m), frame_sets(known.folder), lambda _: None
    )
    truth = load_truth(known.folder.path)
    return score(truth, track).rms_cm, score(truth, _onto(truth, track)).rms_cm


def _onto(truth: Truth, track: RecordedTrack) -> RecordedTrack:
    """The track after the rigid motion that lays its upper body on the truth's."""
    rows = match(truth, track)
    names = JOINT_SETS["upper"]
    mine = np.array([track.joint_names.index(n) for n in names])
    theirs = np.array([truth.names.index(n) for n in names])
    seen = track.joints_m[rows.track_rows][:, mine]
    true = truth.joints_m[rows.truth_rows][:, theirs]
    best = relative_pose(seen.reshape(-1, 3), true.reshape(-1, 3), np.ones(true[..., 0].size))
    return replace(track, joints_m=best.apply(track.joints_m))


def main() -> None:
    """See the head of this file."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("captures", nargs="+", type=Path)
    parser.add_argument("--rms", action="store_true", help="track with both rigs")
    told = parser.parse_args()
    database = load_or_build(default_cache_dir()).database
    for capture in told.captures:
        known = _known(capture)
        found, report = find_extrinsics(known, database)
        true = known.folder.rig
        result = score_extrinsics(found, true)
        line = f"{capture.name:24s}"
        for name, degrees in result.rotation_deg.items():
            line += f" {name} {degrees:5.2f} deg {result.distance_percent[name]:+6.2f} %"
        line += f"  {report.frames} moments, match {report.match:.2f}"
        if told.rms:
            with_true = rms_cm(known, true, database)
            with_found = rms_cm(known, beside_first(found, true), database)
            for how, a, b in zip(("first camera", "aligned"), with_found, with_true, strict=True):
                line += f"  RMS ({how}) {a:.2f} of {b:.2f} cm, {a / b:.2f} x"
        sys.stdout.write(line + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
