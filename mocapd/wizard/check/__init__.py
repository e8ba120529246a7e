"""The step Check: tracking on what was found, judged, and saved."""
