extends Node
## Writes what Godot has of mocapd, a JSON line for each frame and each of two figures, until it has been silent.
##
## In the environment: PROBE_OUT the file to write, PROBE_S the longest time to wait [s]. The last line is of the silence.

var _out: FileAccess
var _seen := {}
var _frames := 0
var _figures := {}


func _ready() -> void:
	_out = FileAccess.open(OS.get_environment("PROBE_OUT"), FileAccess.WRITE)
	await get_tree().process_frame
	var scene := get_tree().current_scene
	_watch("rotation only", scene.get_node("Avatar/Figure"))
	var avatar: MocapdAvatar = preload("res://addons/mocapd/mocapd_avatar.gd").new()
	avatar.bone_update = XRBodyModifier3D.BONE_UPDATE_FULL
	var figure: Skeleton3D = preload("res://sample/humanoid_figure.gd").new()
	avatar.add_child(figure)
	scene.add_child(avatar)
	_watch("full", figure)
	print("probe: ready")


func _process(_delta: float) -> void:
	var receiver: MocapdReceiver = get_node("/root/Mocapd")
	var is_over: bool = not _seen.is_empty() and receiver.tracking(0) == "silent"
	if is_over or Time.get_ticks_msec() > 1000.0 * float(OS.get_environment("PROBE_S")):
		# the receiver has looked after its tracker in this frame or will in the next one
		await get_tree().process_frame
		await get_tree().process_frame
		var body := XRServer.get_tracker("/mocapd/person_0") as XRBodyTracker
		var valid := 0
		for joint in XRBodyTracker.JOINT_MAX:
			valid += int(body.get_joint_flags(joint) != 0)
		_out.store_line(JSON.stringify({"figure": "silent", "has_data": body.has_tracking_data, "valid": valid}))
		_out.close()
		get_tree().quit()


func _watch(figure_name: String, figure: Skeleton3D) -> void:
	figure.skeleton_updated.connect(_on_updated.bind(figure_name, figure))


func _on_updated(figure_name: String, figure: Skeleton3D) -> void:
	var receiver: MocapdReceiver = get_node("/root/Mocapd")
	var frame: Dictionary = receiver._frames.newest_of(0)
	var key := "%s %d" % [figure_name, frame.get("seq", -1)]
	if frame.is_empty() or _seen.has(key) or receiver.tracking(0) in ["lost", "silent"]:
		return
	_seen[key] = true
	var bones := {}
	for bone in figure.get_bone_count():
		var at_m := figure.global_transform * figure.get_bone_global_pose(bone).origin
		bones[figure.get_bone_name(bone)] = [at_m.x, at_m.y, at_m.z]
	var body := XRServer.get_tracker("/mocapd/person_0") as XRBodyTracker
	var joints := {}
	for bone: String in MocapdReceiver.JOINTS:
		var at_m := body.get_joint_transform(MocapdReceiver.JOINTS[bone]).origin
		joints[bone] = [at_m.x, at_m.y, at_m.z]
	var unknown := 0
	for joint in XRBodyTracker.JOINT_MAX:
		if joint != XRBodyTracker.JOINT_ROOT and joint not in MocapdReceiver.JOINTS.values():
			unknown += int(body.get_joint_flags(joint) != 0)
	_out.store_line(
		JSON.stringify(
			{
				"figure": figure_name, "capture_unix_ns": str(frame["capture_unix_ns"]),
				"bones": bones, "joints": joints, "unknown": unknown,
			}
		)
	)
