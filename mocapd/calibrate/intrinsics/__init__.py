"""Focal length, centre and distortion of each camera, and which views they are solved from."""
