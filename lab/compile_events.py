"""What numba compiles while it does: each kernel with its argument types and the seconds of CPU that it took."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from numba.core import event, types


@dataclass(frozen=True, slots=True)
class CompiledKernel:
    """One compilation: module and function, argument types; seconds of this thread's CPU, own_s without what was compiled
    for it on the way, total_s with that."""

    module: str
    function: str
    arguments: tuple[types.Type, ...]
    own_s: float
    total_s: float


class _Listener(event.Listener):
    def __init__(self, compiled: list[CompiledKernel]) -> None:
        self._compiled, self._open = compiled, threading.local()

    def on_start(self, _event: Any) -> None:
        self._stack().append([time.thread_time(), 0.0])

    def on_end(self, ended: Any) -> None:
        stack = self._stack()
        began_s, inner_s = stack.pop()
        total_s = time.thread_time() - began_s
        if stack:
            stack[-1][1] += total_s
        function = ended.data["dispatcher"].py_func
        self._compiled.append(
            CompiledKernel(
                function.__module__,
                function.__qualname__,
                tuple(ended.data["args"]),
                total_s - inner_s,
                total_s,
            )
        )

    def _stack(self) -> list[list[float]]:
        stack: list[list[float]] = self._open.__dict__.setdefault("stack", [])
        return stack


@contextmanager
def compile_events() -> Iterator[list[CompiledKernel]]:
    """A list that fills while the block runs, in the order in which compilations end: callees before callers."""
    compiled: list[CompiledKernel] = []
    with event.install_listener("numba:compile", _Listener(compiled)):
        yield compiled
