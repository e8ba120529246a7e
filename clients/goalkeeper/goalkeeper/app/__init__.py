"""The programs: the game with a window, without one, its measurement and its pictures."""
