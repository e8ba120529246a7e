"""A session that still goes on."""
