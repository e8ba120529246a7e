"""Unix socket by which commands of the same user, and of root, reach a running daemon, with or without the page."""
