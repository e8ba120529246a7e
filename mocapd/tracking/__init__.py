"""One body from many cues: the step machine, its state, what it sees by, and whom it believes."""
