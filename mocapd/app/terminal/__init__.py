"""What a person reads in a terminal: progress, the status line, logs, and test motions."""
