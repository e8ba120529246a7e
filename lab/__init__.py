"""What only we run: training, simulated session sets, studies, and what writes pages of the docs. See README.md."""

import os

from mocapd.app.libraries import LOCATORS

# Read by the libraries while they are imported, as by `mocapd`.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
os.environ.setdefault("NUMBA_CACHE_LOCATOR_CLASSES", LOCATORS)
