"""How a calibration is found out: intrinsics, extrinsics, colours, body shape, and whether a camera was bumped."""
