"""Commands for the operation of a long-running daemon."""
