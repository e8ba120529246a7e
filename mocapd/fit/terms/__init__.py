"""Terms of the fit beside the id maps, one a file."""
