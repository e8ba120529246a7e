"""numba's argument types as JSON, so that a table names what a kernel is compiled for."""

import importlib
import re
from typing import Any

from numba.core import types

from mocapd.errors import MalformedError

Code = str | dict[str, Any]

_ARRAY = re.compile(r"(\w+)\[(\d)([CFA])(r?)\]")


def encode(of: types.Type) -> Code:
    """The code of a type; `decode` gives the type back. Raises MalformedError for one that has no code."""
    code: Code
    if isinstance(of, types.Array):
        code = f"{of.dtype}[{of.ndim}{of.layout}{'' if of.mutable else 'r'}]"
    elif isinstance(of, types.BaseNamedTuple):
        name = f"{of.instance_class.__module__}:{of.instance_class.__qualname__}"
        code = {"named": name, "of": [encode(one) for one in of]}
    elif isinstance(of, types.BaseTuple):
        code = {"tuple": [encode(one) for one in of]}
    elif isinstance(of, types.Literal):
        code = {"literal": of.literal_value}
    elif isinstance(of, types.Omitted):
        code = {"omitted": of.value}
    else:
        code = str(of)
    if decode(code) != of:
        raise MalformedError(f"the type {of} has no code")
    return code


def decode(code: Code) -> types.Type:
    """The type of a code. Raises MalformedError for a code that names nothing."""
    if isinstance(code, str):
        found = _ARRAY.fullmatch(code)
        if found is None:
            return _scalar(code)
        dtype, ndim, layout, readonly = found.groups()
        return types.Array(_scalar(dtype), int(ndim), layout, readonly=bool(readonly))
    if "named" in code:
        return types.BaseTuple.from_types(
            [decode(one) for one in code["of"]], _class_of(code["named"])
        )
    if "tuple" in code:
        return types.BaseTuple.from_types([decode(one) for one in code["tuple"]])
    if "literal" in code:
        return types.literal(code["literal"])
    if "omitted" in code:
        return types.Omitted(code["omitted"])
    raise MalformedError(f"{code} is no code of a type")


def _scalar(name: str) -> types.Type:
    found = types.boolean if name == "bool" else getattr(types, name, None)
    if not isinstance(found, types.Type):
        raise MalformedError(f"{name!r} is no type of numba")
    return found


def _class_of(name: str) -> type:
    module, _, qualified = name.partition(":")
    try:
        found = getattr(importlib.import_module(module), qualified)
    except (ImportError, AttributeError):
        raise MalformedError(f"there is no class {name}") from None
    if not isinstance(found, type):
        raise MalformedError(f"{name} is no class")
    return found
