"""The trackers against the methods as published, and against themselves without one step."""
