"""Motion as VRMA: a GLB file with the extension VRMC_vrm_animation 1.0, which moves any VRM avatar.

By its specification (vrm-c/vrm-specification, VRMC_vrm_animation-1.0): nodes in the T-pose of VRM, rotations of all
bones, translations of the hips alone, no mesh. Bones that no camera saw have a node, which the extension's humanoid needs,
and no motion, so that the avatar keeps its own there.
"""

from mocapd.body.bones import NAMES
from mocapd.errors import InputError
from mocapd.exports.glb.animated_nodes import animation, root_of, skeleton_nodes
from mocapd.exports.glb.gltf_buffer import GltfBuffer, glb_file
from mocapd.exports.sampled_motion import SampledMotion

EXTENSION, _SPEC_VERSION = "VRMC_vrm_animation", "1.0"


def vrma_bytes(motion: SampledMotion) -> bytes:
    """The whole file. Raises InputError for a skeleton that lacks bones of a VRM humanoid."""
    names, buffer, root = motion.skeleton.names, GltfBuffer(), root_of(motion)
    missing = [name for name in NAMES if name not in names]
    if missing or names[root] != "hips":
        what = f"it lacks {missing[0]}" if missing else "its root is not the hips"
        raise InputError(
            f"its skeleton is none of a VRM avatar: {what}",
            fix="export another format by --to",
        )
    bones = [joint for joint, name in enumerate(names) if name in NAMES]
    document = {
        "extensionsUsed": [EXTENSION],
        "scene": 0,
        "scenes": [{"nodes": [root]}],
        "nodes": skeleton_nodes(motion),
        "animations": [
            animation(motion, buffer, [j for j in bones if names[j] not in motion.unmoved], [root])
        ],
        "extensions": {
            EXTENSION: {
                "specVersion": _SPEC_VERSION,
                "humanoid": {"humanBones": {names[joint]: {"node": joint} for joint in bones}},
            }
        },
    }
    return glb_file(document, buffer)
