"""Bodies out of the process: the wire schema and one sink per protocol."""
