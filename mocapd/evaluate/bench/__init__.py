"""Benchmarks of a tracker's step, a live daemon and a long run."""
