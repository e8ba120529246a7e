"""The composition root of a daemon: cameras, pipeline and outputs."""
