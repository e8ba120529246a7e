"""Fuzzers of every parser: what comes from outside ends in a value or a named error, quickly, in little memory."""
