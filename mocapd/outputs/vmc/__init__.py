"""Skeleton frames as Virtual Motion Capture protocol over UDP: what VTuber programs and game engines read."""
