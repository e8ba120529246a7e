"""The composition root: cameras, pipeline and outputs of a running daemon."""
