"""From image to evidence. Pure functions of arrays; every compiled kernel in a `*_kernels` module."""
