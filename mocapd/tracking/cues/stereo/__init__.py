"""Stereo distances between two adjacent cameras."""
