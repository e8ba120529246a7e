"""Where the cameras stand, from a board: pose graph, bundle adjustment, world frame."""
