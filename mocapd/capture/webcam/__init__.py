"""USB webcams: identity, V4L2, controls and their locks, bandwidth."""
