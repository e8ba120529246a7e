"""The game itself: rules, physics, difficulty, score. Pure: no graphics, sound, clock or network."""
