"""The simulated wearer: figure, motion and poses."""
