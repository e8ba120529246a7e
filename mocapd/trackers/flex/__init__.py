"""A person in any clothes before a background that was seen, by two calibrated cameras or more."""
