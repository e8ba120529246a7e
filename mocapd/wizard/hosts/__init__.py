"""The process around a setup: its own, or the running daemon."""
