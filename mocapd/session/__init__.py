"""A session: cameras, calibration and tracker, built from the configuration."""
