"""Other poses that are out of the fit's reach, tried and kept where the pictures bear them better."""
