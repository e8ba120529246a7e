"""The decorator of every kernel: compiled without Python objects, kept on disk, and free of Python's lock while it runs."""

from collections.abc import Callable
from typing import Any

from numba import njit

# Nothing passes a kernel to another as a value, so none needs the C function that numba compiles for that by default: a
# twentieth of all compiling.
OPTIONS = {"cache": True, "nogil": True, "no_cfunc_wrapper": True}


def kernel(function: Callable[..., Any] | None = None, **options: Any) -> Any:
    """`@kernel`, or `@kernel(...)` with more of numba's options: `error_model`, `fastmath`, `inline`."""
    decorate = njit(**OPTIONS, **options)
    return decorate if function is None else decorate(function)
