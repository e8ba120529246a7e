"""Commands for whoever looks after a daemon that runs for months."""
