"""What is seen, with Panda3D."""
