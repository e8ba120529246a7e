"""Sessions that the simulator records of clips of real motion, so that no choice rests on single captures."""
