"""Frames from webcams, files, folders, network cameras and simulated webcams."""
