"""Light: too dark, over-exposed, flickering; and the control value that gives a wanted reading."""
