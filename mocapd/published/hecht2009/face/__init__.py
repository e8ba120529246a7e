"""Faces in pictures: detection, the colour of skin and head, depth from two views."""
