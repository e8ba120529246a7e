"""The decorator of every kernel: compiled without Python objects, kept on disk, and free of Python's lock while it runs."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar, overload

import numba

if TYPE_CHECKING:
    from numba.core.dispatcher import Dispatcher

_Function = TypeVar("_Function", bound=Callable[..., object])

# Nothing passes a kernel to another as a value, so none needs the C function that numba compiles for that by default: a
# twentieth of all compiling.
OPTIONS = {"cache": True, "nogil": True, "no_cfunc_wrapper": True}
_njit: Any = numba.njit  # its types lack that option


@overload
def kernel(function: _Function, /) -> "Dispatcher[_Function]": ...
@overload
def kernel(**options: Any) -> "Callable[[_Function], Dispatcher[_Function]]": ...
def kernel(function: Callable[..., object] | None = None, /, **options: Any) -> Any:
    """`@kernel`, or `@kernel(...)` with more of numba's options: `error_model`, `fastmath`, `inline`."""
    decorate = _njit(**OPTIONS, **options)
    return decorate if function is None else decorate(function)
