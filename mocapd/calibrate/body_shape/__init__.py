"""The wearer's proportions, and whether their scale agrees with the extrinsics."""
