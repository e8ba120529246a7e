extends Node
## Writes each new pose that an add-on's VMC receiver gives its XRBodyTracker, as JSON lines.
##
## In the environment: PROBE_OUT the file to write, PROBE_S how long after the first pose, and after the start [s],
## PROBE_TRACKER the tracker's name.

const JOINTS := {
	"Hips": XRBodyTracker.JOINT_HIPS,
	"Spine": XRBodyTracker.JOINT_SPINE,
	"Chest": XRBodyTracker.JOINT_CHEST,
	"UpperChest": XRBodyTracker.JOINT_UPPER_CHEST,
	"Neck": XRBodyTracker.JOINT_NECK,
	"Head": XRBodyTracker.JOINT_HEAD,
	"LeftUpperArm": XRBodyTracker.JOINT_LEFT_UPPER_ARM,
	"LeftLowerArm": XRBodyTracker.JOINT_LEFT_LOWER_ARM,
	"LeftHand": XRBodyTracker.JOINT_LEFT_HAND,
	"RightUpperArm": XRBodyTracker.JOINT_RIGHT_UPPER_ARM,
	"RightLowerArm": XRBodyTracker.JOINT_RIGHT_LOWER_ARM,
	"RightHand": XRBodyTracker.JOINT_RIGHT_HAND,
	"LeftUpperLeg": XRBodyTracker.JOINT_LEFT_UPPER_LEG,
	"LeftLowerLeg": XRBodyTracker.JOINT_LEFT_LOWER_LEG,
	"LeftFoot": XRBodyTracker.JOINT_LEFT_FOOT,
	"RightUpperLeg": XRBodyTracker.JOINT_RIGHT_UPPER_LEG,
	"RightLowerLeg": XRBodyTracker.JOINT_RIGHT_LOWER_LEG,
	"RightFoot": XRBodyTracker.JOINT_RIGHT_FOOT,
}

var _out: FileAccess
var _last := ""


func _ready() -> void:
	_out = FileAccess.open(OS.get_environment("PROBE_OUT"), FileAccess.WRITE)
	print("probe: ready")


func _process(_delta: float) -> void:
	if Time.get_ticks_msec() > 1000.0 * float(OS.get_environment("PROBE_S")):
		_out.close()
		get_tree().quit()
		return
	var body := XRServer.get_tracker(OS.get_environment("PROBE_TRACKER")) as XRBodyTracker
	if body == null or not body.has_tracking_data:
		return
	var joints := {}
	for bone: String in JOINTS:
		var at_m := body.get_joint_transform(JOINTS[bone]).origin
		joints[bone] = [at_m.x, at_m.y, at_m.z]
	var line := JSON.stringify(joints)
	if line != _last:
		_last = line
		_out.store_line(line)
