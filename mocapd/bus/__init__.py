"""Zenoh for whoever opens a session: what a client needs, limits, calls at the end of the process."""
