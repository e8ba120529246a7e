"""The daemon's run: its loop, signals, first session, page, and what the service manager is told."""
