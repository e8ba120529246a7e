"""The simulated room: furniture, lamps, shadows, and the empty picture of it."""
