"""The commands about recordings: record, replay, export."""
