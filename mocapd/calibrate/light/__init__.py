"""Light: too dark, over-exposed, flickering; and the search for a control's value."""
