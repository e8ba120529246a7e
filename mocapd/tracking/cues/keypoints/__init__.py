"""Joints that a network sees."""
