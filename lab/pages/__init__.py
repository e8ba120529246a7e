"""Pages of the docs that are printed from measurements, with their plots."""
