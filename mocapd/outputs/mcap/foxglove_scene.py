"""From frames, rest skeleton and rig to Foxglove's messages. Pure.

Frames of reference: `world` is ours (+Y up), its parent `foxglove` has +Z up, as Foxglove displays; a bone is
`person0/leftHand`, a camera `camera/left`. Bones are lines that move with their frames, and so are written once.
Numbers are rounded to a millimetre and a tenth of a degree: they are for display, the file also has the exact frames.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from mocapd.capture.recording.recorded_picture import Time, camera_frame
from mocapd.geometry import rotations
from mocapd.outputs.mcap.foxglove_messages import (
    CameraCalibration,
    Color,
    FrameTransform,
    FrameTransforms,
    LinePrimitive,
    PrimitivePose,
    Quaternion,
    SceneEntity,
    SceneUpdate,
    Vector3,
)
from mocapd.outputs.messages import CalibrationInfo, RestSkeleton
from mocapd.outputs.wire import SkeletonFrame

ROOT, WORLD = "foxglove", "world"
_UPRIGHT = Quaternion(*(float(x) for x in rotations.exp(np.array([np.pi / 2, 0.0, 0.0]))))
_HERE = PrimitivePose(Vector3(0.0, 0.0, 0.0), Quaternion(0.0, 0.0, 0.0, 1.0))
_LEFT, _RIGHT = Color(0.2, 0.5, 1.0, 1.0), Color(1.0, 0.45, 0.2, 1.0)
_MIDDLE = Color(0.9, 0.9, 0.9, 1.0)
_THICKNESS_M = 0.02
_LINE_LIST = 2


def bone_frame(person: int, bone: str) -> str:
    """The name of a bone's frame of reference."""
    return f"person{person}/{bone}"


def bone_transforms(frame: SkeletonFrame, rest: RestSkeleton) -> FrameTransforms | None:
    """The pose of every bone in its parent's frame; None for a frame with other bones, or none."""
    if tuple(frame.joints) != rest.names:
        return None
    time = Time.of(frame.capture_unix_ns)
    transforms = []
    for name, parent, offset_m in zip(rest.names, rest.parents, rest.offsets_m, strict=True):
        joint = frame.joints[name]
        place = joint.p if parent < 0 else offset_m
        transforms.append(
            FrameTransform(
                time,
                WORLD if parent < 0 else bone_frame(frame.person, rest.names[parent]),
                bone_frame(frame.person, name),
                Vector3(*(round(x, 3) for x in place)),
                Quaternion(*(round(x, 3) for x in joint.l)),
            )
        )
    return FrameTransforms(transforms)


def bone_scene(rest: RestSkeleton, unix_ns: int) -> SceneUpdate:
    """A line from each joint to each of its children, in the frame of the joint."""
    lines: dict[str, list[Vector3]] = {name: [] for name in rest.names}
    for parent, offset_m in zip(rest.parents, rest.offsets_m, strict=True):
        if parent >= 0:
            lines[rest.names[parent]] += [Vector3(0.0, 0.0, 0.0), Vector3(*offset_m)]
    time = Time.of(unix_ns)
    return SceneUpdate(
        [],
        [_entity(time, rest.person, name, points) for name, points in lines.items() if points],
    )


def _entity(time: Time, person: int, name: str, points: list[Vector3]) -> SceneEntity:
    color = _LEFT if name.startswith("left") else _RIGHT if name.startswith("right") else _MIDDLE
    frame = bone_frame(person, name)
    line = LinePrimitive(_LINE_LIST, _HERE, _THICKNESS_M, False, points, color, [], [])
    return SceneEntity(time, frame, frame, Time(0, 0), True, [], [], [], [], [], [line], [], [], [])


def fixed_transforms(calibration: CalibrationInfo | None, unix_ns: int) -> FrameTransforms:
    """The transforms that do not move: Foxglove's frame to the world, and every camera in it."""
    time = Time.of(unix_ns)
    transforms = [FrameTransform(time, ROOT, WORLD, Vector3(0.0, 0.0, 0.0), _UPRIGHT)]
    for camera in calibration.cameras if calibration is not None else ():
        world_from_camera = np.array(camera.R).reshape(3, 3).T
        place = -world_from_camera @ np.array(camera.t_m)
        turn = rotations.from_matrix(world_from_camera)
        transforms.append(
            FrameTransform(
                time,
                WORLD,
                camera_frame(camera.name),
                Vector3(*place.tolist()),
                Quaternion(*turn.tolist()),
            )
        )
    return FrameTransforms(transforms)


def lens_messages(calibration: CalibrationInfo, unix_ns: int) -> dict[str, CameraCalibration]:
    """Each camera's intrinsics by its name."""
    time = Time.of(unix_ns)
    return {
        camera.name: CameraCalibration(
            time,
            camera_frame(camera.name),
            *camera.size_px,
            "plumb_bob",
            list(camera.dist),
            list(camera.K),
            [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
            _projection(camera.K),
        )
        for camera in calibration.cameras
    }


def _projection(K: Sequence[float]) -> list[float]:
    """K with a fourth column of zeros."""
    rows = pairwise(range(0, 12, 3))
    return [number for start, end in rows for number in (*K[start:end], 0.0)]
