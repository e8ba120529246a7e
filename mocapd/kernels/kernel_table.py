"""The kernels that a first start compiles, with their argument types and what each costs: `calib/kernels.json`.

`python -m lab.kernel_seconds --write` makes the table anew. A kernel that it lacks is compiled when it is first called.
"""

import importlib
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from numba.core import types
from numba.core.dispatcher import Dispatcher

from mocapd.assets import asset_path
from mocapd.boundary.files import read_text
from mocapd.boundary.parsing import parse_json
from mocapd.errors import MalformedError
from mocapd.kernels.callees import callees
from mocapd.kernels.type_codes import Code, decode

TABLE = "kernels.json"
_MOST_BYTES = 1 << 22


@dataclass(frozen=True, eq=False)
class KernelRow:
    """One compilation: `module` and `function`; `codes` of its argument types; `seconds` of CPU on the machine that the table
    was made on; `stages`: what needs it."""

    module: str
    function: str
    codes: tuple[Code, ...]
    seconds: float
    stages: frozenset[str]

    @cached_property
    def dispatcher(self) -> Any:
        """The kernel, a Dispatcher. Raises MalformedError where there is none of this name."""
        try:
            found = getattr(importlib.import_module(self.module), self.function)
        except (ImportError, AttributeError):
            raise MalformedError(f"there is no kernel {self.module}.{self.function}") from None
        if not isinstance(found, Dispatcher):
            raise MalformedError(f"{self.module}.{self.function} is no kernel")
        return found

    @cached_property
    def arguments(self) -> tuple[types.Type, ...]:
        """Raises MalformedError."""
        return tuple(decode(code) for code in self.codes)


def read_table() -> tuple[KernelRow, ...]:
    """All rows, callees before their callers. Raises InputError where the file is missing or damaged."""
    return tuple(_row(one) for one in parse_json(read_text(asset_path(TABLE), _MOST_BYTES)))


def _row(one: dict[str, Any]) -> KernelRow:
    module, _, function = one["kernel"].rpartition(".")
    return KernelRow(
        module, function, tuple(one["types"]), one["seconds"], frozenset(one["stages"])
    )


def rows_of(rows: Sequence[KernelRow], stages: Collection[str]) -> tuple[KernelRow, ...]:
    """Those that one of these stages needs."""
    return tuple(row for row in rows if row.stages & set(stages))


def callees_of_rows(rows: Sequence[KernelRow]) -> tuple[frozenset[int], ...]:
    """For each row, the indices of earlier rows that must be compiled before it, so that nobody compiles them twice."""
    where: dict[Any, list[int]] = {}
    for i, row in enumerate(rows):
        where.setdefault(row.dispatcher, []).append(i)
    return tuple(
        frozenset(
            j for callee in callees(row.dispatcher.py_func) for j in where.get(callee, ()) if j < i
        )
        for i, row in enumerate(rows)
    )
