"""The step Lens: each camera's intrinsics from views of the board."""
