"""Gathers facts of the machine without judging them."""
