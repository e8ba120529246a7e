"""File names of the pose database; a module of its own, so that it imports nothing."""

CACHE_NAME = "pose_database.bin"  # in the cache folder
BEGINNING_NAME = "pose_database.beginning"  # likewise, until the whole is made
