# A frame to joints as Godot's XR trackers have them: absolute, with the axes of SkeletonProfileHumanoid.
#
# Godot has the world's axes of mocapd (right-handed, +Y up, metres), so positions stay as they are. A bone's
# own axes are those of the profile's reference pose: Y points along the bone. A joint is valid when it and all
# joints above it are known, and tracked when there is evidence for it. Keeps to what Godot 3 and Godot 4
# both run: `Basis` and `Vector3` are in both, transforms and quaternions are not.

const BONES = [
	"hips", "spine", "chest", "upperChest", "neck", "head",
	"leftShoulder", "leftUpperArm", "leftLowerArm", "leftHand",
	"rightShoulder", "rightUpperArm", "rightLowerArm", "rightHand",
	"leftUpperLeg", "leftLowerLeg", "leftFoot", "leftToes",
	"rightUpperLeg", "rightLowerLeg", "rightFoot", "rightToes",
]
const PARENT_OF = {
	"spine": "hips", "chest": "spine", "upperChest": "chest", "neck": "upperChest", "head": "neck",
	"leftShoulder": "upperChest", "leftUpperArm": "leftShoulder",
	"leftLowerArm": "leftUpperArm", "leftHand": "leftLowerArm",
	"rightShoulder": "upperChest", "rightUpperArm": "rightShoulder",
	"rightLowerArm": "rightUpperArm", "rightHand": "rightLowerArm",
	"leftUpperLeg": "hips", "leftLowerLeg": "leftUpperLeg",
	"leftFoot": "leftLowerLeg", "leftToes": "leftFoot",
	"rightUpperLeg": "hips", "rightLowerLeg": "rightUpperLeg",
	"rightFoot": "rightLowerLeg", "rightToes": "rightFoot",
}

# X and Y of a bone in the T-pose, in the world; Z is X cross Y. Where not named: those of the world.
# Source: reference poses of SkeletonProfileHumanoid, scene/resources/skeleton_profile.cpp of Godot 4.
const AXES_OF = {
	"leftShoulder": [Vector3(0, 0, 1), Vector3(1, 0, 0)],
	"leftUpperArm": [Vector3(0, 0, -1), Vector3(1, 0, 0)],
	"leftLowerArm": [Vector3(0, -1, 0), Vector3(1, 0, 0)],
	"leftHand": [Vector3(0, 0, -1), Vector3(1, 0, 0)],
	"rightShoulder": [Vector3(0, 0, -1), Vector3(-1, 0, 0)],
	"rightUpperArm": [Vector3(0, 0, 1), Vector3(-1, 0, 0)],
	"rightLowerArm": [Vector3(0, 1, 0), Vector3(-1, 0, 0)],
	"rightHand": [Vector3(0, 0, 1), Vector3(-1, 0, 0)],
	"leftUpperLeg": [Vector3(-1, 0, 0), Vector3(0, -1, 0)],
	"leftLowerLeg": [Vector3(1, 0, 0), Vector3(0, -1, 0)],
	"leftFoot": [Vector3(-1, 0, 0), Vector3(0, 0, 1)],
	"leftToes": [Vector3(1, 0, 0), Vector3(0, 0, 1)],
	"rightUpperLeg": [Vector3(-1, 0, 0), Vector3(0, -1, 0)],
	"rightLowerLeg": [Vector3(1, 0, 0), Vector3(0, -1, 0)],
	"rightFoot": [Vector3(-1, 0, 0), Vector3(0, 0, 1)],
	"rightToes": [Vector3(1, 0, 0), Vector3(0, 0, 1)],
}

# The bits of XRBodyTracker.JointFlags: orientation and position
const VALID = 1 | 4
const TRACKED = 2 | 8

const LYING = 0.1  # with less of the hips' side level, no heading is taken from it


# Of a frame's joints, by VRM 1.0 name: an array of origin [m], basis and flags. Empty when it is lost.
# With a confidence up to `tracked_above` a joint is valid but not tracked, and none is while coasting.
static func joints(frame: Dictionary, tracked_above: float) -> Dictionary:
	var out: Dictionary = {}
	if frame["tracking"] == "lost":
		return out
	var sent: Dictionary = frame["joints"]
	for bone in BONES:  # parents before their children
		if not sent.has(bone) or (PARENT_OF.has(bone) and not out.has(PARENT_OF[bone])):
			continue
		var numbers: Array = sent[bone]
		var flags: int = VALID
		if frame["tracking"] == "live" and numbers[11] > tracked_above:
			flags = VALID | TRACKED
		out[bone] = [Vector3(numbers[0], numbers[1], numbers[2]), _basis(bone, numbers), flags]
	return out


# The heading of a body with these hips: Y up and -Z to where it faces, as Godot's XR nodes have it.
# Lying on its side it has none: then that of before.
static func heading(hips: Basis, before: Basis) -> Basis:
	var left: Vector3 = Vector3(hips.x.x, 0.0, hips.x.z)
	if left.length() < LYING:
		return before
	left = left.normalized()
	return Basis(-left, Vector3(0, 1, 0), left.cross(Vector3(0, -1, 0)))


static func _basis(bone: String, numbers: Array) -> Basis:
	var x: Vector3 = Vector3(1, 0, 0)
	var y: Vector3 = Vector3(0, 1, 0)
	if AXES_OF.has(bone):
		x = AXES_OF[bone][0]
		y = AXES_OF[bone][1]
	var axis: Vector3 = Vector3(numbers[3], numbers[4], numbers[5])
	var w: float = numbers[6]
	var size: float = sqrt(axis.dot(axis) + w * w)
	x = _turned(axis / size, w / size, x)
	y = _turned(axis / size, w / size, y)
	return Basis(x, y, x.cross(y))


# By the unit quaternion of this vector part and this w.
static func _turned(axis: Vector3, w: float, v: Vector3) -> Vector3:
	var twice: Vector3 = axis.cross(v) * 2.0
	return v + twice * w + axis.cross(twice)
