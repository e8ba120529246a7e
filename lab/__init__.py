"""What only we run: training, simulated session sets, studies, and what writes pages of the docs. See README.md."""

import os

import mocapd.kernels  # noqa: F401 -- before numba, which some of what is here imports by itself

# Read by the libraries while they are imported, as by `mocapd`.
for _name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
