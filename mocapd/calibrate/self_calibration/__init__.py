"""Extrinsics from the wearer alone: poses, body shape and cameras in one solution."""
