"""Skeleton frames as OSC bundles over UDP."""
