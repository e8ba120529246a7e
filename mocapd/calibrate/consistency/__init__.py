"""Checks the description of cameras (extrinsics, intrinsics, times) against their pictures."""
