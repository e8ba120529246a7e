"""The shirt in pictures: its colours, where it is seen, and the poses it may be in."""
