"""Frames for games in the browser, on pages of sites that the user has allowed."""
