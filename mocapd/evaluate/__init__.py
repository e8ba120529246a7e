"""How good a tracker is: recorded captures are tracked and held against their ground truth."""
