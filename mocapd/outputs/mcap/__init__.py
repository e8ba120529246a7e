"""Recordings: one MCAP file with frames as published, state, calibration and pictures."""
