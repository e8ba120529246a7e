"""Poses out of the fit's reach: what tells that the pose is wrong, and what is tried in its place."""
