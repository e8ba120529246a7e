"""Trackers as their authors published them, behind the same `Tracker` interface, each with the pieces that only it uses."""
