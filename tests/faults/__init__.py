"""Faults done to real processes, a row of docs/faults.md each."""

import os

from mocapd.app.libraries import LOCATORS

# Before numba is imported: else it would compile for itself what the daemons have compiled already.
os.environ.setdefault("NUMBA_CACHE_LOCATOR_CLASSES", LOCATORS)
