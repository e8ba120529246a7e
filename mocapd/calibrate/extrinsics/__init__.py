"""Extrinsics from a board: pose graph, bundle adjustment, world frame."""
