"""The head in space: a particle filter over what all cameras see of it."""
