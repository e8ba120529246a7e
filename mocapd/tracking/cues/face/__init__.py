"""Faces: they tell which way somebody looks."""
