"""Captures that were made wrong on purpose, and what the checks before tracking say of each."""
