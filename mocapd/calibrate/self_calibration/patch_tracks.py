"""Tracks the wearer in each camera alone: body, classified patches and marks, before extrinsics exist."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.shape import mean_shape
from mocapd.body.skeleton import INDEX
from mocapd.errors import ConfigError
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import to_camera
from mocapd.geometry.nominal_rig import nominal_rig
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.tracking.body_tracker import BodyTracker
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue
from mocapd.types import Bytes, Camera, Floats, FrameSet, Rig, Tracking

# Points of the body with a well-defined image in one camera: joint centres, because the centre of the
# visible part of a patch is another point of the cloth from every side.
MARKS = np.array(
    [
        INDEX[name]
        for name in (
            "hips", "neck", "leftUpperArm", "leftLowerArm", "leftHand",
            "rightUpperArm", "rightLowerArm", "rightHand",
        )
    ]
)  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class PatchSighting:
    """The body in one camera at one instant, in that camera's frame.

    joints_m (J,3), quats_xyzw (J,4) from the T-pose's axes to the camera's, confidence (J,); ids (h,w): the classified
    picture over roi_px (x0, y0, x1, y1 of the frame).
    """

    t_ns: int
    joints_m: Floats
    quats_xyzw: Floats
    confidence: Floats
    ids: Bytes
    roi_px: tuple[int, int, int, int]

    @property
    def marks_xy(self) -> Floats:
        """The marks (M,2) in undistorted normalised coordinates."""
        points = self.joints_m[MARKS]
        xy: Floats = points[:, :2] / points[:, 2:]
        return xy


PatchObservation = Mapping[str, PatchSighting]  # by camera, of one frame set


def place_nominally(bare_cameras: Sequence[Camera]) -> tuple[Camera, ...]:
    """The cameras with their intrinsics alone, each at the nominal pose of a single webcam."""
    usual = [nominal_rig(camera.name, camera.size_px).cameras[0] for camera in bare_cameras]
    pairs = zip(bare_cameras, usual, strict=True)
    return tuple(replace(camera, R=guess.R, t_m=guess.t_m) for camera, guess in pairs)


class PatchTracks:
    """Tracks the wearer in every camera separately; takes frame sets, live or recorded."""

    def __init__(
        self,
        bare_cameras: Sequence[Camera],
        stature_m: float,
        colour_model: ColourModel,
        white_balance: Mapping[str, Floats],
        database: PoseDatabase,
    ) -> None:
        """Of `bare_cameras` only name, size, K and dist are read. white_balance: W (3,3) by camera name."""
        if len(bare_cameras) < 2:
            raise ConfigError(
                f"{len(bare_cameras)} camera",
                "room",
                "two or more cameras make a room; one needs none",
            )
        self.cameras = place_nominally(bare_cameras)
        rigs = [Rig((camera,)) for camera in self.cameras]
        shirts = [ShirtCue(rig, stature_m, colour_model, white_balance, database) for rig in rigs]
        self._trackers = [
            BodyTracker("shirt", rig, stature_m, shirt, None)
            for rig, shirt in zip(rigs, shirts, strict=True)
        ]
        self._shapes = [mean_shape(stature_m) for _ in rigs]
        self.observations: list[PatchObservation] = []

    def add(self, frames: FrameSet) -> PatchObservation:
        """Track one frame set: the sightings by camera."""
        sightings: dict[str, PatchSighting] = {}
        for i, (camera, tracker) in enumerate(zip(self.cameras, self._trackers, strict=True)):
            frame = frames.frames.get(camera.name)
            if frame is None:
                continue
            track = tracker.step(FrameSet(frame.t_ns, {camera.name: frame}), self._shapes[i])
            self._shapes[i] = track.shape
            body = track.body
            if body.tracking is not Tracking.LIVE or body.pose is None or body.joints_m is None:
                continue
            if camera.name not in track.evidence:
                continue
            camera_from_world_xyzw = rotations.from_matrix(camera.R)
            sightings[camera.name] = PatchSighting(
                frame.t_ns,
                to_camera(camera, body.joints_m),
                rotations.multiply(camera_from_world_xyzw, body.pose.quats_xyzw),
                body.confidence,
                track.evidence[camera.name],
                track.roi_px[camera.name],
            )
        self.observations.append(sightings)
        return sightings
