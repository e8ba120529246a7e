"""Rao and Hodges: limbs of ellipsoids, tracked by an annealed particle filter in points of the visual hull."""
