"""`mocapd doctor`: what of this machine may keep mocapd from tracking, and the line that mends it."""
