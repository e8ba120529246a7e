"""Implementation of the commands: the setup's hosts, the daemon's main loop, the first start."""
