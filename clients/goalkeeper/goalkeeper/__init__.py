"""A goalkeeper game: balls are shot at you, and your own body, seen by mocapd, keeps them out."""
