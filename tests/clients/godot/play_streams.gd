# Plays streams to the add-on's decoder and prints what it makes of them; for godot3-server -s.
#
# In the environment:
#   MOCAPD_STREAMS  a JSON file: name of the stream: list of [time [s], datagram in hexadecimal or null]
#   MOCAPD_AVATARS  a JSON file: name of the avatar: rests_m and heights_m as mocapd_feet.gd has them
#   MOCAPD_PLAYED   the file to write: name: what was there after each step, and at the end
#   MOCAPD_PORT     a free port, to which the first stream is sent over UDP as well
extends SceneTree

const Frames = preload("res://addons/mocapd/mocapd_frames.gd")
const Humanoid = preload("res://addons/mocapd/mocapd_humanoid.gd")
const Feet = preload("res://addons/mocapd/mocapd_feet.gd")
const Socket = preload("res://addons/mocapd/mocapd_socket.gd")

const PERSONS = [0, 1]
const TRACKED_ABOVE = 0.5


var avatars = {}


func _init() -> void:
	var file = File.new()
	file.open(OS.get_environment("MOCAPD_AVATARS"), File.READ)
	avatars = parse_json(file.get_as_text())
	file.close()
	for name in avatars:
		var rests_m = avatars[name]["rests_m"]
		for bone in rests_m:
			rests_m[bone] = Vector3(rests_m[bone][0], rests_m[bone][1], rests_m[bone][2])
	file.open(OS.get_environment("MOCAPD_STREAMS"), File.READ)
	var streams = parse_json(file.get_as_text())
	file.close()
	var played = {}
	for name in streams:
		played[name] = played_stream(streams[name])
	played["over UDP"] = played_over_udp(streams["golden"], int(OS.get_environment("MOCAPD_PORT")))
	file.open(OS.get_environment("MOCAPD_PLAYED"), File.WRITE)
	file.store_string(to_json(played))
	file.close()
	quit()


func played_stream(stream) -> Dictionary:
	var frames = Frames.new()
	var steps = []
	for step in stream:
		var person = -1
		if step[1] != null:
			person = frames.take(from_hex(step[1]), step[0])
		steps.append([person, frames.tracking(0, step[0])])
	return result(frames, steps, stream[stream.size() - 1][0])


# Through the system's own sockets; the time is told as in a stream, nothing waits for a clock.
func played_over_udp(stream, port: int) -> Dictionary:
	var frames = Frames.new()
	var socket = Socket.new()
	var error = socket.open(port, "127.0.0.1")
	var sender = PacketPeerUDP.new()
	sender.set_dest_address("127.0.0.1", port)
	for step in stream:
		if step[1] != null:
			sender.put_packet(from_hex(step[1]))
	var persons = []
	for _attempt in range(1000):
		persons += socket.drain(frames, 0.0)
		if persons.size() > 0:
			break
		OS.delay_msec(1)
	socket.close()
	var out = result(frames, [[persons[0] if persons.size() > 0 else -1, frames.tracking(0, 0.0)]], 0.0)
	out["opened"] = error == OK
	return out


func result(frames, steps, end_s: float) -> Dictionary:
	var out = {"steps": steps, "trouble": frames.trouble, "status": frames.status(0, end_s)}
	var persons = {}
	for person in PERSONS:
		var frame = frames.newest_of(person)
		if frame.size() > 0:
			persons[str(person)] = described(frame)
	out["persons"] = persons
	return out


func described(frame: Dictionary) -> Dictionary:
	var joints = Humanoid.joints(frame, TRACKED_ABOVE)
	var told = {}
	for bone in joints:
		var basis = joints[bone][1]
		told[bone] = {
			"origin": numbers(joints[bone][0]), "flags": joints[bone][2],
			"x": numbers(basis.x), "y": numbers(basis.y), "z": numbers(basis.z),
		}
	var out = {
		"seq": frame["seq"], "capture_unix_ns": str(frame["capture_unix_ns"]),
		"instance": frame["instance"], "tracking": frame["tracking"], "joints": told,
	}
	if joints.has("hips"):
		var before = Basis(Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1))
		var heading = Humanoid.heading(joints["hips"][1], before)
		out["motion_scale"] = {}
		for name in avatars:
			out["motion_scale"][name] = scale_of(joints, avatars[name])
		out["heading"] = {"x": numbers(heading.x), "y": numbers(heading.y), "z": numbers(heading.z)}
	return out


func scale_of(joints: Dictionary, avatar: Dictionary) -> float:
	for bone in Feet.bones():
		if not joints.has(bone):
			return 0.0
	return Feet.motion_scale(joints, avatar["rests_m"], avatar["heights_m"])


func numbers(v: Vector3) -> Array:
	return [v.x, v.y, v.z]


func from_hex(text: String) -> PoolByteArray:
	var bytes = PoolByteArray()
	bytes.resize(text.length() / 2)
	for place in range(bytes.size()):
		bytes[place] = ("0x" + text.substr(place * 2, 2)).hex_to_int()
	return bytes
