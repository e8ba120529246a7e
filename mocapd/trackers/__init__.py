"""The trackers that a configuration can name: the body tracker of each profile, those of the papers, and a canned one."""
