extends Skeleton3D
## A figure of capsules on the reference skeleton of SkeletonProfileHumanoid: an avatar without any file.

const LIMBS: Array[StringName] = [
	&"Spine", &"Chest", &"UpperChest", &"Neck", &"Head",
	&"LeftUpperArm", &"LeftLowerArm", &"LeftHand", &"RightUpperArm", &"RightLowerArm", &"RightHand",
	&"LeftLowerLeg", &"LeftFoot", &"LeftToes", &"RightLowerLeg", &"RightFoot", &"RightToes",
]
const RADIUS_M := 0.045
const HEAD_RADIUS_M := 0.1
const LEFT_COLOUR := Color(0.85, 0.35, 0.2)
const RIGHT_COLOUR := Color(0.2, 0.45, 0.85)
const TRUNK_COLOUR := Color(0.8, 0.8, 0.75)


# Before the node above, which looks for the bones when it is ready
func _init() -> void:
	var profile := SkeletonProfileHumanoid.new()
	for place in profile.bone_size:
		add_bone(profile.get_bone_name(place))
	for place in profile.bone_size:
		set_bone_parent(place, find_bone(profile.get_bone_parent(place)))
		set_bone_rest(place, profile.get_reference_pose(place))
	reset_bone_poses()


func _ready() -> void:
	for limb in LIMBS:
		_add_limb(find_bone(limb))
	_add_mesh(find_bone("Head"), _sphere(), Vector3(0.0, HEAD_RADIUS_M, 0.0), TRUNK_COLOUR)


# A capsule from the joint above to this one: bones of this profile point along their Y. In the rest pose ankles and
# toes are on the floor, so a foot lies above their line (its Z points up), and a shin ends at the ankle.
func _add_limb(bone: int) -> void:
	var length_m := get_bone_rest(bone).origin.length()
	var at_m := Vector3(0.0, 0.5 * length_m, 0.0)
	var capsule := CapsuleMesh.new()
	capsule.radius = RADIUS_M
	capsule.height = length_m + 2.0 * RADIUS_M
	if get_bone_name(bone).ends_with("Toes"):
		at_m.z = RADIUS_M
	elif get_bone_name(bone).ends_with("Foot"):
		capsule.height -= RADIUS_M
		at_m.y -= 0.5 * RADIUS_M
	var colour := TRUNK_COLOUR
	if get_bone_name(bone).begins_with("Left"):
		colour = LEFT_COLOUR
	elif get_bone_name(bone).begins_with("Right"):
		colour = RIGHT_COLOUR
	_add_mesh(get_bone_parent(bone), capsule, at_m, colour)


func _add_mesh(bone: int, mesh: PrimitiveMesh, at_m: Vector3, colour: Color) -> void:
	var material := StandardMaterial3D.new()
	material.albedo_color = colour
	mesh.material = material
	var instance := MeshInstance3D.new()
	instance.mesh = mesh
	instance.position = at_m
	var attachment := BoneAttachment3D.new()
	add_child(attachment)
	attachment.bone_idx = bone
	attachment.add_child(instance)


func _sphere() -> SphereMesh:
	var sphere := SphereMesh.new()
	sphere.radius = HEAD_RADIUS_M
	sphere.height = 2.0 * HEAD_RADIUS_M
	return sphere
