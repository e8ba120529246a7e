"""Rotations, cameras and rigs, triangulation. Pure numpy."""
