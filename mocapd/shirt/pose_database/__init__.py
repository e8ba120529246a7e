"""80,000 poses by the id map of their shirt, and the index over them."""
