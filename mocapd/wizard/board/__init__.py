"""Common parts of the steps with a board: detection, form, advice, sightings."""
