"""GLB: Blender, Godot, three.js and whatever reads glTF 2.0."""
