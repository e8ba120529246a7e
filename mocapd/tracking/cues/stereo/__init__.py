"""Distances between two cameras beside each other."""
