# Datagrams to whole frames: of each person the newest one, and whether it still holds.
#
# A frame comes as one datagram or several (docs/wire.md of mocapd); parts of different frames are never
# mixed. A frame is a Dictionary: person, seq, capture_unix_ns, latency_s, tracking, tracker, cameras,
# instance, heard_s, and `joints`, by VRM 1.0 name: px py pz, rx ry rz rw, lx ly lz lw, c, as on the wire.
# Keeps to what Godot 3 and Godot 4 both run.

const Osc = preload("mocapd_osc.gd")

const MAX_PERSONS = 16
const MAX_PARTS = 64
const MAX_JOINTS = 256
const MAX_COLLECTED = 64  # frames begun and not whole, of all persons and senders
const FAR_M = 1000.0  # no joint is as far from the origin
const SEQ_MASK = 0x7FFFFFFF  # seq counts modulo 2^31
const SEQ_HALF = 0x40000000
const LOST_S = 3.0  # "lost" is said once a second
const TRACKING = ["live", "coasting", "lost"]

const NUMBER = "number"
const IN_PART = "in_part"
const SECOND_SENDER = "second_sender"

const WORDS = {
	Osc.NOT_OSC: "what is no OSC",
	Osc.CUT_OFF: "datagrams that are cut off",
	Osc.FOREIGN: "messages of another program",
	Osc.NEWER: "a newer schema than v1, which needs a newer version of this add-on",
	Osc.TYPES: "arguments of the wrong types",
	NUMBER: "numbers that cannot be",
	IN_PART: "frames of which a part is missing",
	SECOND_SENDER: "a second daemon, which is not listened to",
}

# After so long without a frame there is no tracking: a live daemon sends ten a second and more [s].
var silence_s: float = 0.5
# How often each kind of trouble came, and what the last one was about.
var trouble: Dictionary = {}
var trouble_about: Dictionary = {}

var _osc = Osc.new()
var _newest: Dictionary = {}  # person: frame
var _begun: Dictionary = {}  # person and sender: frame of which parts are missing


# Takes a datagram that came at a time of the caller's clock [s]. The person whose newest frame
# it made whole, or -1.
func take(datagram, now_s: float) -> int:
	_osc.read(datagram)
	for problem in _osc.problems:
		_complain(problem[0], problem[1])
	var whole: Dictionary = _whole(_osc.messages, now_s)
	if whole.size() == 0:
		return -1
	whole["heard_s"] = now_s
	_newest[whole["person"]] = whole
	return whole["person"]


# The newest whole frame of a person; empty where there is none yet.
func newest_of(person: int) -> Dictionary:
	return _newest.get(person, {})


# live, coasting or lost; "silent" when nothing has come for a while, or never.
func tracking(person: int, now_s: float) -> String:
	if not _newest.has(person):
		return "silent"
	var newest: Dictionary = _newest[person]
	var holds_s: float = silence_s
	if newest["tracking"] == "lost":
		holds_s = max(silence_s, LOST_S)
	return newest["tracking"] if now_s - newest["heard_s"] <= holds_s else "silent"


# One line for people.
func status(person: int, now_s: float) -> String:
	var words: String = ""
	var newest: Dictionary = newest_of(person)
	match tracking(person, now_s):
		"silent":
			if newest.size() == 0:
				words = "nothing heard of person %d yet: is mocapd running, and sending OSC here?" % person
			else:
				words = "silent for %.1f s: %s has stopped" % [now_s - newest["heard_s"], newest["instance"]]
		"lost":
			words = "lost: %s sees nobody" % newest["instance"]
		var state:
			words = (
				"%s: %s by %s, %d ms old when sent"
				% [state, newest["instance"], newest["tracker"], int(newest["latency_s"] * 1000.0)]
			)
	for kind in trouble:
		words += "; %d x %s" % [trouble[kind], WORDS[kind]]
		if trouble_about[kind] != "":
			words += " (%s)" % trouble_about[kind]
	return words


func _complain(kind: String, about: String) -> void:
	trouble[kind] = trouble.get(kind, 0) + 1
	trouble_about[kind] = about


# The frame that these messages of a datagram make whole; empty where they do not.
func _whole(messages: Array, now_s: float) -> Dictionary:
	var part: Dictionary = _opened(messages)
	if part.size() == 0 or not _is_wanted(part, now_s):
		return {}
	var key: String = "%d %s" % [part["person"], part["instance"]]
	var frame: Dictionary = _collected(key, part, now_s)
	if frame.size() == 0:
		return {}
	for place in range(1, messages.size()):
		_add_joint(frame, messages[place])
	frame["missing"].erase(messages[0][3])
	if frame["missing"].size() > 0:
		return {}
	_begun.erase(key)
	if frame["joints"].size() + frame["refused"].size() != frame["joint_count"]:
		_complain(IN_PART, "frame %d" % frame["seq"])
		return {}
	return frame


# The frame that a datagram begins with, without its joints; empty where it does not, or where it cannot be.
func _opened(messages: Array) -> Dictionary:
	if messages.size() == 0:
		return {}
	if messages[0][0] != Osc.FRAME:
		_complain(IN_PART, messages[0][0])
		return {}
	var frame: Dictionary = _begin(messages[0])
	if frame.size() == 0:
		_complain(NUMBER, Osc.FRAME)
	return frame


# A frame without its joints, from the message; empty where a number or a word cannot be.
func _begin(head: Array) -> Dictionary:
	var parts: int = head[4]
	var possible: bool = (
		head[1] >= 0 and head[1] < MAX_PERSONS and head[2] >= 0
		and parts > 0 and parts <= MAX_PARTS and head[3] >= 0 and head[3] < parts
		and head[5] >= 0 and head[5] <= MAX_JOINTS
		and head[7] >= 0 and head[7] < 1000000000 and _is_finite(head[8]) and head[9] in TRACKING
	)
	if not possible:
		return {}
	return {
		"person": head[1],
		"seq": head[2],
		"parts": parts,
		"joint_count": head[5],
		"capture_unix_ns": (head[6] & 0xFFFFFFFF) * 1000000000 + head[7],  # the seconds are unsigned
		"latency_s": head[8],
		"tracking": head[9],
		"tracker": head[10],
		"cameras": head[11],
		"instance": head[12],
		"joints": {},
		"refused": {},  # joints with numbers that cannot be
		"missing": range(parts),
	}


# While frames come, only later ones of the same daemon are.
func _is_wanted(part: Dictionary, now_s: float) -> bool:
	if tracking(part["person"], now_s) == "silent":
		return true
	var before: Dictionary = _newest[part["person"]]
	if before["instance"] != part["instance"]:
		_complain(SECOND_SENDER, part["instance"])
		return false
	return _is_newer(part, before)


# The frame that this part belongs to, begun now or before; empty where a newer one was begun a moment ago.
func _collected(key: String, part: Dictionary, now_s: float) -> Dictionary:
	if _begun.has(key):
		var before: Dictionary = _begun[key]
		if before["seq"] == part["seq"] and before["capture_unix_ns"] == part["capture_unix_ns"]:
			if before["parts"] == part["parts"] and before["joint_count"] == part["joint_count"]:
				return before
		elif now_s - before["heard_s"] <= silence_s and not _is_newer(part, before):
			return {}
		_complain(IN_PART, "frame %d" % before["seq"])
	elif _begun.size() >= MAX_COLLECTED:
		_begun.clear()
	part["heard_s"] = now_s
	_begun[key] = part
	return part


func _add_joint(part: Dictionary, message: Array) -> void:
	if not message[0].begins_with(Osc.JOINT):
		return
	var bone: String = message[0].substr(Osc.JOINT.length(), message[0].length())
	var numbers: Array = message.slice(1, 13)  # Godot 3 includes the end, Godot 4 does not: twelve either way
	if _is_joint(numbers):
		part["joints"][bone] = numbers
	else:
		part["refused"][bone] = true
		_complain(NUMBER, bone)


# By its number or by its time: a daemon that was started anew counts from 0, a recording goes back in time.
static func _is_newer(part: Dictionary, before: Dictionary) -> bool:
	var ahead: int = (part["seq"] - before["seq"]) & SEQ_MASK
	if ahead > 0 and ahead < SEQ_HALF:
		return true
	return part["capture_unix_ns"] > before["capture_unix_ns"]


static func _is_joint(numbers: Array) -> bool:
	for number in numbers:
		if not _is_finite(number):
			return false
	for place in range(3):
		if abs(numbers[place]) > FAR_M:
			return false
	return _is_turn(numbers, 3) and _is_turn(numbers, 7)


# Whether the four numbers are nearly a unit quaternion.
static func _is_turn(numbers: Array, at: int) -> bool:
	var square: float = 0.0
	for place in range(at, at + 4):
		square += numbers[place] * numbers[place]
	return abs(square - 1.0) < 0.01


static func _is_finite(number: float) -> bool:
	return not (is_nan(number) or is_inf(number))
