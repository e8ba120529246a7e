"""Whether a setup is good enough: what a tracker sees of somebody, measured and judged."""
