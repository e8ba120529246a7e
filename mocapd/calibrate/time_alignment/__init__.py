"""The offsets between the clocks of recordings, from the motion of the board that all of them show."""
