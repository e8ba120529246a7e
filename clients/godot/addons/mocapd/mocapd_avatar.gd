class_name MocapdAvatar
extends XRNode3D
## Moves the avatar below it as a person does: stands it where they stand and poses its skeleton.
##
## Put the avatar's scene under this node, untransformed; its [Skeleton3D] must have been retargeted to
## [SkeletonProfileHumanoid] in the import dialogue (bone renamer and rest fixer). The posing is done by the
## engine's own [XRBodyModifier3D].

const Feet := preload("mocapd_feet.gd")

## Number of the person, as mocapd counts.
@export_range(0, 15) var person: int = 0
## Rotation only: the avatar keeps its bone lengths. Full: it gets the person's.
@export
var bone_update: XRBodyModifier3D.BoneUpdate = XRBodyModifier3D.BONE_UPDATE_ROTATION_ONLY
## With rotation only: hold the hips as high as the avatar's own legs and feet need to stand on the floor.
@export var fit_legs: bool = true

var _skeleton: Skeleton3D
var _rests_m := {}  # of its legs, see mocapd_feet.gd
var _heights_m := {}


func _ready() -> void:
	tracker = MocapdReceiver.tracker_name(person)
	pose = &"default"
	var skeletons := find_children("*", "Skeleton3D", true, false)
	if skeletons.is_empty():
		push_error("mocapd: there is no Skeleton3D under %s: put the avatar's scene there" % get_path())
		set_process(false)
		return
	_skeleton = skeletons[0]
	_measure_legs()
	var modifier := XRBodyModifier3D.new()
	modifier.body_tracker = tracker
	modifier.bone_update = bone_update
	_skeleton.add_child(modifier)


func _process(_delta: float) -> void:
	var body := XRServer.get_tracker(tracker) as XRBodyTracker
	if body == null or not body.has_tracking_data or _rests_m.is_empty():
		return
	var scale_now := 1.0
	if fit_legs and bone_update == XRBodyModifier3D.BONE_UPDATE_ROTATION_ONLY:
		var joints := {}
		for bone: String in Feet.bones():
			var joint: XRBodyTracker.Joint = MocapdReceiver.JOINTS[bone]
			if body.get_joint_flags(joint) == 0:
				return
			var placed := body.get_joint_transform(joint)
			joints[bone] = [placed.origin, placed.basis]
		scale_now = Feet.motion_scale(joints, _rests_m, _heights_m)
	if scale_now > 0.0:
		_skeleton.motion_scale = scale_now


# What Feet needs of the avatar's legs in its rest pose; nothing where a bone of them is missing.
func _measure_legs() -> void:
	for bone: String in Feet.bones().slice(1):
		var name_there := bone.left(1).to_upper() + bone.substr(1)
		var place := _skeleton.find_bone(name_there)
		if place >= 0:
			_rests_m[bone] = _skeleton.get_bone_rest(place).origin
			if bone.ends_with("Foot") or bone.ends_with("Toes"):
				_heights_m[bone] = _skeleton.get_bone_global_rest(place).origin.y
		elif not bone.ends_with("Toes"):
			push_error("mocapd: %s is not retargeted to SkeletonProfileHumanoid" % _skeleton.get_path())
			_rests_m.clear()
			return
