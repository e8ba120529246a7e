"""Cameras of other machines: their address, what their node sends, and its clock related to ours."""
