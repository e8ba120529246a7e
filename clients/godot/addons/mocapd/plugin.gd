@tool
extends EditorPlugin
## Enabled in the project's settings, it adds the receiver to every scene as the autoload `Mocapd`.

const AUTOLOAD := "Mocapd"


func _enable_plugin() -> void:
	add_autoload_singleton(AUTOLOAD, "res://addons/mocapd/mocapd_receiver.gd")


func _disable_plugin() -> void:
	remove_autoload_singleton(AUTOLOAD)
