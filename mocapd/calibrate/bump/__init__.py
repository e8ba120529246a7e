"""Whether a camera was turned since it was calibrated."""
