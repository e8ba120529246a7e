"""Validation of all bytes and text from outside: returns a value or raises a named error."""
