"""Packets kept as files, for the tests of outputs and of clients, and the commands that make them."""
