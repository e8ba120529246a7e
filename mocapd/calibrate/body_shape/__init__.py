"""Measures the wearer's proportions, and compares their scale with the extrinsics."""
