"""For Blender's Python: imports a file of mocapd and writes where its joints are in each frame, as JSON, and how far each
is from the nearest vertex of a figure that the armature moves, where the file has one.

    blender -b --factory-startup --python-exit-code 9 --python look.py -- bvh|glb FILE OUT RATE_HZ FRAMES

Blender's world has +Z up, mocapd's +Y: joints are written in mocapd's.
"""

import json
import sys
from pathlib import Path
from typing import Any

import bpy
from mathutils.kdtree import KDTree

kind, file, out, rate_hz, frames = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.object.select_all(action="SELECT")
bpy.ops.object.delete()
if kind == "bvh":
    bpy.ops.import_anim.bvh(filepath=file, global_scale=0.01, update_scene_fps=True)
else:
    bpy.ops.import_scene.gltf(filepath=file)
scene = bpy.context.scene
(armature,) = [one for one in scene.objects if one.type == "ARMATURE"]
scene_hz = scene.render.fps / scene.render.fps_base
# a BVH's first frame is frame 1; a glTF's is frame 0
first = armature.animation_data.action.frame_range[0]
skins = [one for one in scene.objects if one.type == "MESH" and one.find_armature() is armature]


def nearest_m(joints: dict[str, Any], graph: Any) -> dict[str, float]:
    """How far each joint is from the figure [m]."""
    skin = skins[0].evaluated_get(graph)
    vertices = skin.to_mesh().vertices
    tree = KDTree(len(vertices))
    for i, vertex in enumerate(vertices):
        tree.insert(skin.matrix_world @ vertex.co, i)
    tree.balance()
    found = {name: tree.find(at_m)[2] for name, at_m in joints.items()}
    skin.to_mesh_clear()
    return found


poses, figure = [], []
for number in range(int(frames)):
    at = first + number / float(rate_hz) * scene_hz
    scene.frame_set(int(at), subframe=at - int(at))
    graph = bpy.context.evaluated_depsgraph_get()
    evaluated = armature.evaluated_get(graph)
    heads = {b.name: evaluated.matrix_world @ b.head for b in evaluated.pose.bones}
    poses.append({name: [at_m.x, at_m.z, -at_m.y] for name, at_m in heads.items()})
    if len(skins) == 1:
        figure.append(nearest_m(heads, graph))
Path(out).write_text(json.dumps({"scene_hz": scene_hz, "poses": poses, "figure": figure}))
