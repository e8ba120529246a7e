"""What is heard: made by code, played with Panda3D."""
