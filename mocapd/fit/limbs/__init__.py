"""Hypothesis search for arms and legs that disagree with the pictures."""
