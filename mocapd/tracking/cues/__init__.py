"""The cues of the body tracker, one folder each."""
