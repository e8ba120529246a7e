"""What the commands run: hosts of the setup, the daemon's run with signals and status line, the first start."""
