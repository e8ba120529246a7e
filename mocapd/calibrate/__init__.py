"""Computes a calibration: intrinsics, extrinsics, colours, body shape; and detects bumped cameras."""
