class_name MocapdAvatar
extends XRNode3D
## Moves the avatar below it as a person does: stands it where they stand and poses its skeleton.
##
## Put the avatar's scene under this node, untransformed; its [Skeleton3D] must have been retargeted to
## [SkeletonProfileHumanoid] in the import dialogue (bone renamer and rest fixer). The posing is done by the
## engine's own [XRBodyModifier3D].

const NOTICEABLE := 0.01  # a leg longer by this part of itself

## Number of the person, as mocapd counts.
@export_range(0, 15) var person: int = 0
## Rotation only: the avatar keeps its bone lengths. Full: it gets the person's.
@export
var bone_update: XRBodyModifier3D.BoneUpdate = XRBodyModifier3D.BONE_UPDATE_ROTATION_ONLY
## With rotation only: scale how high the hips are by the legs' lengths, so that the feet stay on the floor.
@export var fit_legs: bool = true

var _skeleton: Skeleton3D
var _leg_m := 0.0  # the avatar's, from hip to ankle


func _ready() -> void:
	tracker = MocapdReceiver.tracker_name(person)
	pose = &"default"
	var skeletons := find_children("*", "Skeleton3D", true, false)
	if skeletons.is_empty():
		push_error("mocapd: there is no Skeleton3D under %s: put the avatar's scene there" % get_path())
		set_process(false)
		return
	_skeleton = skeletons[0]
	_leg_m = _rest_length_m("LeftUpperLeg", "LeftLowerLeg") + _rest_length_m("LeftLowerLeg", "LeftFoot")
	if _leg_m == 0.0:
		push_error("mocapd: %s is not retargeted to SkeletonProfileHumanoid" % _skeleton.get_path())
	var modifier := XRBodyModifier3D.new()
	modifier.body_tracker = tracker
	modifier.bone_update = bone_update
	_skeleton.add_child(modifier)


func _process(_delta: float) -> void:
	var body := XRServer.get_tracker(tracker) as XRBodyTracker
	if body == null or not body.has_tracking_data or _leg_m == 0.0:
		return
	var scale_now := 1.0
	if fit_legs and bone_update == XRBodyModifier3D.BONE_UPDATE_ROTATION_ONLY:
		var person_leg_m := (
			_length_m(body, XRBodyTracker.JOINT_LEFT_UPPER_LEG, XRBodyTracker.JOINT_LEFT_LOWER_LEG)
			+ _length_m(body, XRBodyTracker.JOINT_LEFT_LOWER_LEG, XRBodyTracker.JOINT_LEFT_FOOT)
		)
		if body.get_joint_flags(XRBodyTracker.JOINT_LEFT_FOOT) == 0 or person_leg_m == 0.0:
			return
		scale_now = _leg_m / person_leg_m
	if absf(scale_now - _skeleton.motion_scale) > NOTICEABLE * scale_now:
		_skeleton.motion_scale = scale_now


func _rest_length_m(from: String, to: String) -> float:
	var first := _skeleton.find_bone(from)
	var second := _skeleton.find_bone(to)
	if first < 0 or second < 0:
		return 0.0
	var first_at := _skeleton.get_bone_global_rest(first).origin
	return first_at.distance_to(_skeleton.get_bone_global_rest(second).origin)


func _length_m(
	body: XRBodyTracker, from: XRBodyTracker.Joint, to: XRBodyTracker.Joint
) -> float:
	var from_at := body.get_joint_transform(from).origin
	return from_at.distance_to(body.get_joint_transform(to).origin)
