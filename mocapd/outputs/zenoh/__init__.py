"""Skeleton frames and state on Zenoh."""
