"""Verifies a setup: measures how well a tracker follows a person, and judges it."""
