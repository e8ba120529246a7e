"""The step Cameras: which there are, what is wrong with one, and its controls locked."""
