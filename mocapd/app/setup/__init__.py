"""Setups: in a process of their own, or from a folder of recordings, and the selection of a page."""
