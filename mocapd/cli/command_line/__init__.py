"""Parsing of command lines beyond what typer does: groups of options, and removed ones."""
