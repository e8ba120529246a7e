"""The calibration board: its layout, its corners in pictures, its motion, recordings of it."""
