"""Fuzzers of every parser: what comes from outside ends in a value or a named error, quickly, in little memory."""

import os

from mocapd.app.libraries import LOCATORS

# Before numba is imported: else it would compile for itself what the daemons have compiled already.
os.environ.setdefault("NUMBA_CACHE_LOCATOR_CLASSES", LOCATORS)
