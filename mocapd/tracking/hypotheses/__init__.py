"""Alternative poses outside the solver's reach, accepted if the pictures confirm them better."""
