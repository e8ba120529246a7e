"""The daemon's process: main loop, signals, first session, page, and notification of the service manager."""
