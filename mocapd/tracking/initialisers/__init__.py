"""How somebody is found of whom nothing is known."""
