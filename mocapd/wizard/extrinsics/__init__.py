"""The step Room: where the cameras stand, with the board or from the wearer alone."""
