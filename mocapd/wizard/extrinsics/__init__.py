"""The step Room: extrinsics, with the board or from the wearer alone."""
