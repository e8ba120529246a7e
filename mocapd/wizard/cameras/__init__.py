"""The step Cameras: checks the cameras and locks their controls."""
