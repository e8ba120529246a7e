"""The step Check: tracks with the draft, judges and saves it."""
