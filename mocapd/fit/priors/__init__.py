"""Priors of the fit: usual poses, motion, joint limits."""
