"""What a step, a live daemon and a long run cost."""
