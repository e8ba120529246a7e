"""Detects cameras that moved or changed places since the calibration."""
