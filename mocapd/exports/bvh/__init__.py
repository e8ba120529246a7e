"""BVH: Blender, Unity, Unreal, MotionBuilder."""
