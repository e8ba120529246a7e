"""The setup wizard without its page: one step after the other from webcams to a saved calibration."""
