"""Where a person will be in a moment, from frames as they are sent."""
