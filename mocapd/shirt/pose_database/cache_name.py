"""Where the pose database is kept; told without importing what makes it."""

CACHE_NAME = "pose_database.bin"  # in the cache folder
