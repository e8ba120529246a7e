"""Setups: in a process of their own, from a folder of recordings, and where their page is."""
