"""How right the figures are: known motions, sampled and shaken as a tracker does it."""
