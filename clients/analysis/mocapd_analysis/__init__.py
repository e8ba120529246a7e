"""A motion analyst for any sport: what a session of mocapd says about how somebody moved."""
