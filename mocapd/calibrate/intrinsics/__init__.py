"""Intrinsics of each camera, and the selection of views for them."""
