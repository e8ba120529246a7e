"""How commands of the same user, and of root, reach a running daemon: a Unix socket, with or without the page."""
