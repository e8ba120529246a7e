"""The calibration board: detection in pictures, motion, recordings."""
