# Datagrams of OSC 1.0 to messages, as far as mocapd sends them: bundles of messages of i, f and s.
#
# Nothing is believed: every length is checked before it is used, and a datagram that is cut off is
# refused as a whole. Keeps to what Godot 3 and Godot 4 both run, so that the tests of this project can
# run it; see the README.

const FRAME = "/mocapd/v1/frame"
const FRAME_TYPES = "iiiiiiifssss"
const JOINT = "/mocapd/v1/joint/"
const JOINT_TYPES = "ffffffffffff"
const OURS = "/mocapd/"
const V1 = "/mocapd/v1/"

const BUNDLE_HEADER_BYTES = 16  # "#bundle", NUL, and the time tag
const MAX_ADDRESS_BYTES = 128
const MAX_STRING_BYTES = 1024

# What was wrong, by kind; see mocapd_frames.gd for the words.
const NOT_OSC = "not_osc"
const CUT_OFF = "cut_off"
const FOREIGN = "foreign"
const NEWER = "newer"
const TYPES = "types"

# Of the datagram read last: messages, each an array of the address and its arguments, in order,
# and what was wrong, each an array of the kind and what it was about.
var messages: Array = []
var problems: Array = []

var _bytes  # PoolByteArray in Godot 3, PackedByteArray in Godot 4
var _buffer = StreamPeerBuffer.new()


func _init() -> void:
	_buffer.big_endian = true


# Reads a datagram into `messages` and `problems`.
func read(datagram) -> void:
	messages = []
	problems = []
	_bytes = datagram
	_buffer.data_array = datagram
	var size: int = datagram.size()
	if size < 4 or size % 4 != 0:
		_complain(NOT_OSC, "")
	elif datagram[0] == 0x2F:  # "/"
		_read_message(0, size)
	elif size >= BUNDLE_HEADER_BYTES and _text(0, size) == "#bundle":
		_read_bundle(size)
	else:
		_complain(NOT_OSC, "")


func _complain(kind: String, about: String) -> void:
	problems.append([kind, about])


func _read_bundle(size: int) -> void:
	var elements: Array = []
	var at: int = BUNDLE_HEADER_BYTES
	while at < size:
		_buffer.seek(at)
		var length: int = _buffer.get_32()
		at += 4
		if length <= 0 or length % 4 != 0 or length > size - at:
			_complain(CUT_OFF, "")
			return
		elements.append([at, at + length])
		at += length
	for element in elements:
		_read_message(element[0], element[1])


func _read_message(at: int, end: int) -> void:
	var address: String = _text(at, end)
	if address.length() < 2 or address.length() > MAX_ADDRESS_BYTES or not address.begins_with("/"):
		_complain(NOT_OSC, "")
		return
	var types_at: int = _behind(at, address.length())
	var types: String = _text(types_at, end)
	if not types.begins_with(","):
		_complain(NOT_OSC, address)
	elif address == FRAME:
		_read_arguments(address, FRAME_TYPES, types, types_at, end)
	elif address.begins_with(JOINT):
		_read_arguments(address, JOINT_TYPES, types, types_at, end)
	elif not address.begins_with(OURS):
		_complain(FOREIGN, address)
	elif not address.begins_with(V1):
		_complain(NEWER, address)
	# what else v1 may send one day is none of ours


# Within v1 arguments are only added, at the end: what follows those that are known is not looked at.
func _read_arguments(address: String, known: String, types: String, types_at: int, end: int) -> void:
	if not types.begins_with("," + known):
		_complain(TYPES, address)
		return
	var message: Array = [address]
	var at: int = _behind(types_at, types.length())
	for place in range(known.length()):
		if known[place] == "s":
			var length: int = _length(at, end)
			if length < 0 or length > MAX_STRING_BYTES:
				_complain(CUT_OFF, address)
				return
			_buffer.seek(at)
			message.append(_buffer.get_utf8_string(length) if length > 0 else "")
			at = _behind(at, length)
			continue
		if at + 4 > end:
			_complain(CUT_OFF, address)
			return
		_buffer.seek(at)
		message.append(_buffer.get_float() if known[place] == "f" else _buffer.get_32())
		at += 4
	messages.append(message)


# How many bytes are before the next NUL; -1 where there is none before the end.
func _length(at: int, end: int) -> int:
	for place in range(at, end):
		if _bytes[place] == 0:
			return place - at
	return -1


# Of plain ASCII, as addresses and type tags are; "" where it is none.
func _text(at: int, end: int) -> String:
	var length: int = _length(at, end)
	if length <= 0:
		return ""
	for place in range(at, at + length):
		if _bytes[place] < 0x21 or _bytes[place] > 0x7E:
			return ""
	_buffer.seek(at)
	return _buffer.get_string(length)


# Where the next thing begins behind a string of so many bytes: it ends with a NUL, padded to 4.
func _behind(at: int, length: int) -> int:
	return at + length + 4 - length % 4
