"""Cameras of a recording: the pictures in an MCAP file as sources, and what the file knows of rig and wearer."""
