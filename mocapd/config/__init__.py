"""The configuration: its keys, sections and sources."""
