"""VRMA: animations for avatars."""
