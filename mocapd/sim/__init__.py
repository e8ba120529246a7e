"""Simulated webcams: scenario file, world as a pure function of time, rendered frames, ground truth."""
