"""Terminal output: progress, the status line, logs, and test motions."""
