"""Kinds of sources: what each address means, in one table."""
