"""Faults done to real processes, a row of docs/faults.md each."""
