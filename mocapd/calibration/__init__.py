"""Calibration data that exist before the first frame, and the files that store them."""
