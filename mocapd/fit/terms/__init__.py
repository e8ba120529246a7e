"""Terms of the fit, one a file."""
