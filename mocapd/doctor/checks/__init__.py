"""Checks: pure functions of gathered facts."""
