"""Evaluation of trackers: tracks recorded captures and compares them with their ground truth."""
