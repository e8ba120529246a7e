extends Node
## Starts the receiver over and over where memory is full of numbers that read as flags, and counts valid joints.
##
## In the environment: STARTS how often. Prints "starts: N, of the engine E, of mocapd M": how many joints of N new
## trackers read as valid before anything was set, as the engine makes them and as the receiver does.

const VALID := XRBodyTracker.JOINT_FLAG_ORIENTATION_VALID | XRBodyTracker.JOINT_FLAG_POSITION_VALID
const NUMBERS := [500, 560, 620, 680, 700, 720, 740, 800]  # of 8 bytes, as large as a tracker and near it
const EACH := 40


func _ready() -> void:
	var starts := int(OS.get_environment("STARTS"))
	var of_engine := 0
	var of_mocapd := 0
	for _start in starts:
		_poison()
		of_engine += _valid_joints(XRBodyTracker.new())
		_poison()
		var receiver: MocapdReceiver = preload("res://addons/mocapd/mocapd_receiver.gd").new()
		ProjectSettings.set_setting("mocapd/port", 0)
		add_child(receiver)
		of_mocapd += _valid_joints(XRServer.get_tracker(MocapdReceiver.tracker_name(0)))
		remove_child(receiver)
		receiver.free()
	print("starts: %d, of the engine %d, of mocapd %d" % [starts, of_engine, of_mocapd])
	get_tree().quit()


# Memory that is given back full of numbers from 0 to 15.
func _poison() -> void:
	var held := []
	for _round in EACH:
		for size: int in NUMBERS:
			var numbers := PackedInt64Array()
			numbers.resize(size)
			numbers.fill(randi() % 16)
			for place in range(0, size, 3):
				numbers[place] = randi() % 16
			held.append(numbers)


func _valid_joints(tracker: XRBodyTracker) -> int:
	var valid := 0
	for joint in XRBodyTracker.JOINT_MAX:
		valid += int(tracker.get_joint_flags(joint) & VALID == VALID)
	return valid
