# The UDP socket that mocapd sends to. Keeps to what Godot 3 and Godot 4 both run.

const MAX_DATAGRAMS = 512  # read at once, so that no flood holds up a game

var _udp = PacketPeerUDP.new()


# Listens on a port of this address, 127.0.0.1 or "*" for all. OK, or the error: somebody else has the port.
func open(port: int, address: String) -> int:
	var method: String = "bind" if _udp.has_method("bind") else "listen"  # Godot 4, Godot 3
	return _udp.call(method, port, address)


func close() -> void:
	_udp.close()


# Reads all that has come into the frames, so that the newest counts. The persons with a new frame, each once.
func drain(frames, now_s: float) -> Array:
	var persons: Array = []
	for _count in range(MAX_DATAGRAMS):
		if _udp.get_available_packet_count() <= 0:
			break
		var person: int = frames.take(_udp.get_packet(), now_s)
		if person >= 0 and not person in persons:
			persons.append(person)
	return persons
