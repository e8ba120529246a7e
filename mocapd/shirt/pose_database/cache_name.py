"""File name of the pose database; a module of its own, so that it imports nothing."""

CACHE_NAME = "pose_database.bin"  # in the cache folder
