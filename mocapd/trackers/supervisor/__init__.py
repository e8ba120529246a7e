"""Which tracker speaks, frame by frame, and one body of what several know."""
