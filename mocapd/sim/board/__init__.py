"""The simulated calibration board, its path and its pictures."""
