"""Motion as BVH: text, a hierarchy and a line of numbers a frame.

Centimetres, as most programs expect; axes as in mocapd, +Y up, facing +Z at rest; the rest pose is the T-pose. Intrinsic
rotations about Z, X, Y in this order, in degrees, as the channels say. Every joint has a translation in each frame, not
only the hips, as bone lengths change while the tracker learns the body: six channels each, which BVH importers accept;
those that support rotations alone use the offsets.
"""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from mocapd.exports.sampled_motion import SampledMotion
from mocapd.geometry import rotations
from mocapd.types import Floats

CM = 100.0
END_CM = 8.0  # the tip of a bone without children, which the format requires
_FRAMES = "Frames:"
_CHANNELS = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation"


def bvh_text(motion: SampledMotion) -> str:
    """The whole file."""
    skeleton = motion.skeleton
    order, lines = _hierarchy(motion)
    places_cm = motion.local_positions_m * CM
    degrees = zxy_degrees(rotations.to_matrix(motion.local_xyzw))
    numbers = np.concatenate([places_cm, degrees], axis=2)[:, order]
    rows = numbers.reshape(len(numbers), 6 * len(skeleton.names))
    return "\n".join(
        [
            "HIERARCHY",
            *lines,
            "MOTION",
            f"{_FRAMES} {len(rows)}",
            f"Frame Time: {1.0 / motion.rate_hz:.9f}",
            *(" ".join(f"{number:.5f}" for number in row) for row in rows.tolist()),
            "",
        ]
    )


def frames_in_bvh(path: Path) -> int:
    """The number of frames in a file of ours: as it says, or fewer where lines are missing."""
    with path.open(encoding="utf-8") as file:
        said = next(line for line in file if line.startswith(_FRAMES))
        next(file)  # the time between them
        return min(int(said.removeprefix(_FRAMES)), sum(1 for _ in file))


def zxy_degrees(R: Floats) -> Floats:
    """Angles (...,3) about z, x, y [degrees] of R = Rz Rx Ry (...,3,3)."""
    x = np.arcsin(np.clip(R[..., 2, 1], -1.0, 1.0))
    z = np.arctan2(-R[..., 0, 1], R[..., 1, 1])
    y = np.arctan2(-R[..., 2, 0], R[..., 2, 2])
    # gimbal lock at straight up or down: z gets the sum of z and y
    level = np.abs(R[..., 2, 1]) > 1.0 - 1e-9
    z = np.where(level, np.arctan2(R[..., 1, 0], R[..., 0, 0]), z)
    y = np.where(level, 0.0, y)
    degrees: Floats = np.degrees(np.stack([z, x, y], axis=-1))
    return degrees


def _hierarchy(motion: SampledMotion) -> tuple[list[int], list[str]]:
    """Joints in the order of the file, depth first, and its lines."""
    order: list[int] = []
    skeleton, offsets_cm = motion.skeleton, motion.offsets_m * CM

    def lines_of(joint: int, depth: int) -> Iterator[str]:
        order.append(joint)
        indent, inner = "\t" * depth, "\t" * (depth + 1)
        x, y, z = offsets_cm[joint].tolist()
        yield f"{indent}{'JOINT' if depth else 'ROOT'} {skeleton.names[joint]}"
        yield f"{indent}{{"
        yield f"{inner}OFFSET {x:.5f} {y:.5f} {z:.5f}"
        yield f"{inner}{_CHANNELS}"
        children = np.flatnonzero(skeleton.parents == joint).tolist()
        for child in children:
            yield from lines_of(child, depth + 1)
        if not children:
            tip = offsets_cm[joint] / max(1e-6, float(np.linalg.norm(offsets_cm[joint]))) * END_CM
            yield f"{inner}End Site"
            yield f"{inner}{{"
            yield f"{inner}\tOFFSET " + " ".join(f"{number:.5f}" for number in tip.tolist())
            yield f"{inner}}}"
        yield f"{indent}}}"

    (root,) = np.flatnonzero(skeleton.parents < 0).tolist()
    return order, list(lines_of(root, 0))
