"""What a kernel's compiled code is made of: its own code, the constants it names, and the kernels that it calls."""

import builtins
import dis
import hashlib
import linecache
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any

import numpy as np
from numba.core.dispatcher import Dispatcher

from mocapd.kernels.decorator import OPTIONS

PythonFunction = Callable[..., Any]

_LOAD_GLOBAL = dis.opmap["LOAD_GLOBAL"]


def callees(function: PythonFunction) -> tuple[Dispatcher, ...]:
    """The kernels that a kernel's Python function calls by name, itself left out."""
    values = (value for _, value in _globals_of(function))
    return tuple(v for v in values if isinstance(v, Dispatcher) and v.py_func is not function)


@cache
def content_of(function: PythonFunction) -> str:
    """A hash of everything that the compiled code of a kernel follows from; comments, lines and its file's place are
    not of it. numba itself looks at the kernel's own file alone, and would run the old code of a changed callee.

    The kernels that it calls and the named tuples that it takes are of it with their modules: numba cannot read code compiled
    for one that has moved.
    """
    digest = hashlib.sha256(repr(OPTIONS).encode())
    for line in _decorator(function.__code__):
        digest.update(line.encode())
    for code in _codes(function.__code__):
        constants = code.co_consts[1:] if isinstance(code.co_consts[0], str) else code.co_consts
        plain = [one for one in constants if not isinstance(one, CodeType)]
        digest.update(code.co_code)
        digest.update(repr((plain, code.co_names, code.co_varnames)).encode())
    for named in _named_tuples(function):
        digest.update(_content(named, function).encode())
    for name, value in _globals_of(function):
        digest.update(f"{name}={_content(value, function)}\n".encode())
    return digest.hexdigest()


def _content(value: Any, function: PythonFunction) -> str:
    if isinstance(value, Dispatcher):
        called = value.py_func
        if called is function:
            return ""  # its own code is there already
        return f"{called.__module__} {content_of(called)}"
    if isinstance(value, ModuleType):
        return value.__name__
    if isinstance(value, np.ndarray):
        return f"{value.dtype}{value.shape}{hashlib.sha256(value.tobytes()).hexdigest()}"
    if isinstance(value, type):
        return f"{value.__module__}.{value.__qualname__}{getattr(value, '_fields', '')}"
    return (
        repr(value)
        if isinstance(value, int | float | complex | str | tuple | np.generic)
        else str(type(value))
    )


def _named_tuples(annotated: Any) -> Iterator[type]:
    """Those that a function takes, or that a named tuple holds, with theirs in turn."""
    for value in annotated.__annotations__.values():
        if isinstance(value, type) and hasattr(value, "_fields"):
            yield value
            yield from _named_tuples(value)


def _globals_of(function: PythonFunction) -> Iterator[tuple[str, Any]]:
    """Names that the code looks up in its module, with their values; a name that comes later in the module has its text."""
    names = {name for code in _codes(function.__code__) for name in _global_names(code)}
    known = function.__globals__
    for name in sorted(names - vars(builtins).keys() | names & known.keys()):
        yield (
            name,
            known[name]
            if name in known
            else Path(function.__code__.co_filename).read_text("utf-8"),
        )


def _global_names(code: CodeType) -> Iterator[str]:
    """Arguments of LOAD_GLOBAL. The instructions of `dis` describe much more, for 70 ms at each start."""
    high = 0
    for opcode, low in zip(code.co_code[::2], code.co_code[1::2], strict=True):
        argument = high << 8 | low
        high = argument if opcode == dis.EXTENDED_ARG else 0
        if opcode == _LOAD_GLOBAL:
            yield code.co_names[argument >> 1]  # its lowest bit is about calls


def _codes(code: CodeType) -> Iterator[CodeType]:
    yield code
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _codes(inner)


def _decorator(code: CodeType) -> Iterator[str]:
    """The lines before `def`: they say how the kernel is compiled."""
    for line in linecache.getlines(code.co_filename)[code.co_firstlineno - 1 :]:
        if line.startswith("def "):
            return
        yield line
