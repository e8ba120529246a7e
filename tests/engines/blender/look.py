"""For Blender's Python: imports a file of mocapd and writes where its joints are in each frame, as JSON.

    blender -b --factory-startup --python-exit-code 9 --python look.py -- bvh|glb FILE OUT RATE_HZ FRAMES

Blender's world has +Z up, mocapd's +Y: joints are written in mocapd's.
"""

import json
import sys
from pathlib import Path

import bpy

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
poses = []
for number in range(int(frames)):
    at = first + number / float(rate_hz) * scene_hz
    scene.frame_set(int(at), subframe=at - int(at))
    evaluated = armature.evaluated_get(bpy.context.evaluated_depsgraph_get())
    heads = {b.name: evaluated.matrix_world @ b.head for b in evaluated.pose.bones}
    poses.append({name: [at_m.x, at_m.z, -at_m.y] for name, at_m in heads.items()})
Path(out).write_text(json.dumps({"scene_hz": scene_hz, "poses": poses}))
