"""A skeleton as glTF nodes in the T-pose, and its motion as one animation of them; node j is joint j.

Metres; glTF's axes equal mocapd's (right-handed, +Y up, a model faces +Z).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from mocapd.exports.glb.gltf_buffer import GltfBuffer
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.types import Floats


def skeleton_nodes(motion: SampledMotion) -> list[dict[str, Any]]:
    skeleton, offsets_m = motion.skeleton, motion.offsets_m
    children = [np.flatnonzero(skeleton.parents == j).tolist() for j in range(len(skeleton.names))]
    return [
        {"name": name, "translation": offsets_m[j].tolist(), "rotation": [0.0, 0.0, 0.0, 1.0]}
        | ({"children": children[j]} if children[j] else {})
        for j, name in enumerate(skeleton.names)
    ]


def root_of(motion: SampledMotion) -> int:
    """The joint without a parent."""
    (root,) = np.flatnonzero(motion.skeleton.parents < 0).tolist()
    return int(root)


def animation(
    motion: SampledMotion, buffer: GltfBuffer, rotating: Sequence[int], moving: Sequence[int]
) -> dict[str, Any]:
    """The animation; rotating, moving: joints with animated rotation and translation relative to the parent."""
    times = buffer.add(motion.times_s[:, None].astype("<f4"), has_range=True)
    samplers: list[dict[str, Any]] = []
    channels: list[dict[str, Any]] = []
    for path, joints, values in (
        ("rotation", rotating, _continuous(motion.local_xyzw)),
        ("translation", moving, motion.local_positions_m),
    ):
        for joint in joints:
            output = buffer.add(values[:, joint].astype("<f4"))
            channels.append({"sampler": len(samplers), "target": {"node": joint, "path": path}})
            samplers.append({"input": times, "output": output, "interpolation": "LINEAR"})
    return {"name": "mocapd", "samplers": samplers, "channels": channels}


def _continuous(quats_xyzw: Floats) -> Floats:
    """The same rotations (F,J,4), each with the sign nearer to the frame before, as players interpolate neighbours."""
    turns = np.sign(np.vecdot(quats_xyzw[1:], quats_xyzw[:-1]))
    signs = np.cumprod(np.where(turns < 0, -1.0, 1.0), axis=0)
    out = quats_xyzw.copy()
    out[1:] *= signs[..., None]
    return out
