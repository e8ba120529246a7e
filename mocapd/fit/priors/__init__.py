"""What holds a pose beside the evidence: where people usually are, how they move, how far joints go."""
