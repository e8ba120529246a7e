"""Motion as an animated figure in a GLB file (binary glTF 2.0).

Each bone is a node with animated rotation and translation, at rest in the T-pose; a skin names the nodes as joints and
moves a figure of capsules. A node's `extras` have the joint's confidence: `confidence` is its mean, `seen` the share
of the frames with a usable confidence, and `confidence_accessor` the number of an accessor with one value for each frame.
"""

import json
import struct
from pathlib import Path
from typing import Any

import numpy as np

from mocapd.exports.glb.animated_nodes import animation, root_of, skeleton_nodes
from mocapd.exports.glb.capsule_figure import capsule_figure
from mocapd.exports.glb.gltf_buffer import INDICES, VERTICES, GltfBuffer, glb_file
from mocapd.exports.sampled_motion import SampledMotion
from mocapd.exports.unseen_limbs import LEAST_CONFIDENCE

_MOST_BYTES = 2**32 - 1  # of the whole file, whose header counts them in 32 bits
_DOCUMENT_BYTES = 16_384  # upper bound of the JSON, for the file as a whole and for each joint
_DISTINCT_TIMES = 2**23  # times must rise, which 32-bit floats of equal steps do up to here


def most_glb_frames(joints: int) -> int:
    """The largest number of frames of a file."""
    of_frame = 4 + joints * (4 * (4 + 3) + 1)
    return min(_DISTINCT_TIMES, (_MOST_BYTES - _DOCUMENT_BYTES * (1 + joints)) // of_frame)


def frames_in_glb(path: Path) -> int:
    """The number of frames in a file of ours; 0 for a truncated one."""
    with path.open("rb") as file:
        _, _, length, size, _ = struct.unpack("<4sIIII", file.read(20))
        document = json.loads(file.read(size))
        if file.seek(0, 2) < length:
            return 0
    times: int = document["animations"][0]["samplers"][0]["input"]
    count: int = document["accessors"][times]["count"]
    return count


def glb_bytes(motion: SampledMotion) -> bytes:
    """The whole file."""
    buffer, joints, root = GltfBuffer(), range(len(motion.skeleton.names)), root_of(motion)
    inverse_bind = np.tile(np.eye(4), (len(joints), 1, 1))
    inverse_bind[:, 3, :3] = -motion.skeleton.rest_m  # by columns, as glTF has matrices
    figure = {"name": "figure", "mesh": 0, "skin": 0}
    document = {
        "scene": 0,
        "scenes": [{"nodes": [root, len(joints)]}],
        "nodes": [*_nodes(motion, buffer), figure],
        "meshes": [_mesh(motion, buffer)],
        "materials": [
            {
                "name": "figure",
                "pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.8},
            }
        ],
        "skins": [
            {
                "joints": [*joints],
                "skeleton": root,
                "inverseBindMatrices": buffer.add(inverse_bind.reshape(-1, 16).astype("<f4")),
            }
        ],
        "animations": [animation(motion, buffer, joints, joints)],
    }
    return glb_file(document, buffer)


def _nodes(motion: SampledMotion, buffer: GltfBuffer) -> list[dict[str, Any]]:
    """Nodes of the joints, with their confidence."""
    confidence = np.clip(motion.confidence, 0.0, 1.0)
    nodes = skeleton_nodes(motion)
    for joint, node in enumerate(nodes):
        steps = np.round(255.0 * confidence[:, joint : joint + 1]).astype("|u1")
        node["extras"] = {
            "confidence": round(float(confidence[:, joint].mean()), 4),
            "seen": round(float((confidence[:, joint] >= LEAST_CONFIDENCE).mean()), 4),
            "confidence_accessor": buffer.add(steps, normalized=True),
        }
    return nodes


def _mesh(motion: SampledMotion, buffer: GltfBuffer) -> dict[str, Any]:
    """One mesh; each vertex follows one joint."""
    figure = capsule_figure(motion.skeleton)
    joints, weights = np.zeros((2, len(figure.joints), 4))
    joints[:, 0], weights[:, 0] = figure.joints, 1.0
    attributes = {
        "POSITION": buffer.add(figure.places_m.astype("<f4"), VERTICES, has_range=True),
        "NORMAL": buffer.add(figure.normals.astype("<f4"), VERTICES),
        "COLOR_0": buffer.add(figure.colours, VERTICES, normalized=True),
        "JOINTS_0": buffer.add(joints.astype("|u1"), VERTICES),
        "WEIGHTS_0": buffer.add(weights.astype("<f4"), VERTICES),
    }
    indices = buffer.add(figure.triangles.reshape(-1, 1).astype("<u2"), INDICES)
    return {
        "name": "figure",
        "primitives": [{"attributes": attributes, "indices": indices, "material": 0}],
    }
