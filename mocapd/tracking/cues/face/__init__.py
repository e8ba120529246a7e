"""Face detection as evidence of the facing direction."""
