"""The compiled kernels as a whole: which there are, what their compiling costs, and when a kept one is still good."""

import os

# numba reads this when it is imported, so whoever runs kernels imports this package first. It takes the first locator that
# accepts a function: the kernels' own, then its default ones.
os.environ["NUMBA_CACHE_LOCATOR_CLASSES"] = (
    "mocapd.kernels.locator.KernelLocator,UserProvidedCacheLocator,InTreeCacheLocator,UserWideCacheLocator,"
    "IPythonCacheLocator,ZipCacheLocator"
)
