"""Simulated webcams: a scenario's film, or a stage on which scenes are played."""
