"""The colour-shirt tracker: one to N cameras (Wang, Paris, Popovic 2011, and what improves on it)."""
