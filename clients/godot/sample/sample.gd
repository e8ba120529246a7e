extends Node3D
## Shows what the receiver says of person 0. The figure is moved by the MocapdAvatar above it.

@onready var _receiver: MocapdReceiver = get_node("/root/Mocapd")
@onready var _words: Label = $Words


func _process(_delta: float) -> void:
	_words.text = _receiver.status(0)
