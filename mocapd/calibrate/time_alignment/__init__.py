"""The offsets between the clocks of recordings, from the board's motion in all of them."""
