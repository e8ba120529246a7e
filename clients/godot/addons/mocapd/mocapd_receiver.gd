class_name MocapdReceiver
extends Node
## Listens to mocapd and keeps an [XRBodyTracker] for each person up to date.
##
## The trackers are called "/mocapd/person_0", "/mocapd/person_1" and so on. Put an [XRBodyModifier3D] with that
## name under a [Skeleton3D], or a [MocapdAvatar] above the avatar, which does it for you. Godot 4.3 or later.

## A new frame of a person came; see mocapd_frames.gd for what is in it.
signal frame_received(person: int, frame: Dictionary)
## Tracking of a person is now "live", "coasting", "lost" or "silent".
signal tracking_changed(person: int, tracking: String)
## Trouble of a kind that has not been before; one line for people.
signal trouble_came(words: String)

const Frames := preload("mocapd_frames.gd")
const Humanoid := preload("mocapd_humanoid.gd")
const Socket := preload("mocapd_socket.gd")

const JOINTS := {
	"hips": XRBodyTracker.JOINT_HIPS,
	"spine": XRBodyTracker.JOINT_SPINE,
	"chest": XRBodyTracker.JOINT_CHEST,
	"upperChest": XRBodyTracker.JOINT_UPPER_CHEST,
	"neck": XRBodyTracker.JOINT_NECK,
	"head": XRBodyTracker.JOINT_HEAD,
	"leftShoulder": XRBodyTracker.JOINT_LEFT_SHOULDER,
	"leftUpperArm": XRBodyTracker.JOINT_LEFT_UPPER_ARM,
	"leftLowerArm": XRBodyTracker.JOINT_LEFT_LOWER_ARM,
	"leftHand": XRBodyTracker.JOINT_LEFT_HAND,
	"rightShoulder": XRBodyTracker.JOINT_RIGHT_SHOULDER,
	"rightUpperArm": XRBodyTracker.JOINT_RIGHT_UPPER_ARM,
	"rightLowerArm": XRBodyTracker.JOINT_RIGHT_LOWER_ARM,
	"rightHand": XRBodyTracker.JOINT_RIGHT_HAND,
	"leftUpperLeg": XRBodyTracker.JOINT_LEFT_UPPER_LEG,
	"leftLowerLeg": XRBodyTracker.JOINT_LEFT_LOWER_LEG,
	"leftFoot": XRBodyTracker.JOINT_LEFT_FOOT,
	"leftToes": XRBodyTracker.JOINT_LEFT_TOES,
	"rightUpperLeg": XRBodyTracker.JOINT_RIGHT_UPPER_LEG,
	"rightLowerLeg": XRBodyTracker.JOINT_RIGHT_LOWER_LEG,
	"rightFoot": XRBodyTracker.JOINT_RIGHT_FOOT,
	"rightToes": XRBodyTracker.JOINT_RIGHT_TOES,
}
const BODY_FLAGS := (
	XRBodyTracker.BODY_FLAG_UPPER_BODY_SUPPORTED | XRBodyTracker.BODY_FLAG_LOWER_BODY_SUPPORTED
)
const POSE := "default"

## UDP port that mocapd sends to (its key osc.destinations). The project setting mocapd/port overrules it.
@export var port: int = 39541
## Address to listen on; "*" hears other machines too. The project setting mocapd/address overrules it.
@export var address: String = "127.0.0.1"
## How many persons have a tracker, numbered from 0. The project setting mocapd/persons overrules it.
@export_range(1, 16) var persons: int = 1
## After so long without a frame there is no tracking data [s].
@export var silence_s: float = 0.5
## A joint is flagged as tracked when mocapd's confidence in it is above this.
@export_range(0.0, 1.0) var tracked_above: float = 0.15

var _frames := Frames.new()
var _socket := Socket.new()
var _trackers: Array[XRBodyTracker] = []
var _tracking: Array[String] = []
var _headings: Array[Basis] = []
var _kinds_said := 0


## The name under which the XRServer knows a person's tracker.
static func tracker_name(person: int) -> StringName:
	return StringName("/mocapd/person_%d" % person)


func _enter_tree() -> void:
	port = ProjectSettings.get_setting("mocapd/port", port)
	address = ProjectSettings.get_setting("mocapd/address", address)
	persons = ProjectSettings.get_setting("mocapd/persons", persons)
	_frames.silence_s = silence_s
	var error: int = _socket.open(port, address)
	if error != OK:
		push_error("mocapd: cannot listen on %s:%d: %s" % [address, port, error_string(error)])
	for person in persons:
		var tracker := XRBodyTracker.new()
		tracker.name = tracker_name(person)
		tracker.description = "mocapd, person %d" % person
		tracker.body_flags = BODY_FLAGS
		# The engine leaves them uninitialised: joints that are never set here could read as valid.
		for joint in XRBodyTracker.JOINT_MAX:
			tracker.set_joint_flags(joint, 0)
		XRServer.add_tracker(tracker)
		_trackers.append(tracker)
		_tracking.append("silent")
		_headings.append(Basis.IDENTITY)


func _exit_tree() -> void:
	_socket.close()
	for tracker in _trackers:
		XRServer.remove_tracker(tracker)
	_trackers.clear()
	_tracking.clear()
	_headings.clear()


func _process(_delta: float) -> void:
	var now_s := _now_s()
	for person: int in _socket.drain(_frames, now_s):
		if person < _trackers.size():
			_fill(person, _frames.newest_of(person))
			frame_received.emit(person, _frames.newest_of(person))
	for person in _trackers.size():
		_look_after(person, _frames.tracking(person, now_s))
	if _frames.trouble.size() > _kinds_said:
		_kinds_said = _frames.trouble.size()
		push_warning("mocapd: " + status(0))
		trouble_came.emit(status(0))


## live, coasting, lost or silent.
func tracking(person: int) -> String:
	return _frames.tracking(person, _now_s())


## One line for people: who is tracked by whom, or why nobody is, and what was wrong with what came.
func status(person: int) -> String:
	return _frames.status(person, _now_s())


func _now_s() -> float:
	return Time.get_ticks_usec() * 1e-6


func _fill(person: int, frame: Dictionary) -> void:
	var tracker := _trackers[person]
	var joints: Dictionary = Humanoid.joints(frame, tracked_above)
	for bone: String in JOINTS:
		if not joints.has(bone):
			tracker.set_joint_flags(JOINTS[bone], 0)
			continue
		tracker.set_joint_transform(JOINTS[bone], Transform3D(joints[bone][1], joints[bone][0]))
		tracker.set_joint_flags(JOINTS[bone], joints[bone][2])
	if not joints.has("hips"):
		_forget(tracker)
		return
	_headings[person] = Humanoid.heading(joints["hips"][1], _headings[person])
	var hips: Vector3 = joints["hips"][0]
	var root := Transform3D(_headings[person], Vector3(hips.x, 0.0, hips.z))
	var is_tracked: bool = (
		(joints["hips"][2] & XRBodyTracker.JOINT_FLAG_POSITION_TRACKED) != 0
	)
	tracker.set_joint_transform(XRBodyTracker.JOINT_ROOT, root)
	tracker.set_joint_flags(XRBodyTracker.JOINT_ROOT, joints["hips"][2])
	tracker.set_pose(
		POSE,
		root,
		Vector3.ZERO,
		Vector3.ZERO,
		XRPose.XR_TRACKING_CONFIDENCE_HIGH if is_tracked else XRPose.XR_TRACKING_CONFIDENCE_LOW
	)
	tracker.has_tracking_data = true


# What is known of a person nobody sees, or of whom nothing is heard, is nothing.
func _look_after(person: int, tracking_now: String) -> void:
	if tracking_now in ["lost", "silent"]:
		_forget(_trackers[person])
	if tracking_now != _tracking[person]:
		_tracking[person] = tracking_now
		tracking_changed.emit(person, tracking_now)


func _forget(tracker: XRBodyTracker) -> void:
	if not tracker.has_tracking_data:
		return
	tracker.has_tracking_data = false
	tracker.set_joint_flags(XRBodyTracker.JOINT_ROOT, 0)
	for bone: String in JOINTS:
		tracker.set_joint_flags(JOINTS[bone], 0)
	tracker.invalidate_pose(POSE)
