"""What one run works on: cameras, calibration and tracker, from the configuration."""
