"""numba's argument types as JSON, so that a table names what a kernel is compiled for."""

import importlib
import re
from typing import Any

from numba.core import types

from mocapd.errors import MalformedError

Code = str | dict[str, Any]

_types: Any = types  # its functions carry no types

_ARRAY = re.compile(r"(\w+)\[(\d)([CFA])(r?)\]")


def encode(of: Any) -> Code:
    """The code of a type; `decode` gives the type back. Raises MalformedError for one that has no code."""
    code: Code
    if isinstance(of, _types.Array):
        code = f"{of.dtype}[{of.ndim}{of.layout}{'' if of.mutable else 'r'}]"
    elif isinstance(of, _types.BaseNamedTuple):
        name = f"{of.instance_class.__module__}:{of.instance_class.__qualname__}"
        code = {"named": name, "of": [encode(one) for one in of]}
    elif isinstance(of, _types.BaseTuple):
        code = {"tuple": [encode(one) for one in of]}
    elif isinstance(of, _types.Literal):
        code = {"literal": of.literal_value}
    elif isinstance(of, _types.Omitted):
        code = {"omitted": of.value}
    else:
        code = str(of)
    if decode(code) != of:
        raise MalformedError(f"the type {of} has no code")
    return code


def decode(code: Code) -> types.Type:
    """The type of a code. Raises MalformedError for a code that names nothing."""
    if isinstance(code, str):
        match = _ARRAY.fullmatch(code)
        if match is None:
            return _scalar(code)
        dtype, ndim, layout, readonly = match.groups()
        array: types.Type = _types.Array(_scalar(dtype), int(ndim), layout, readonly=bool(readonly))
        return array
    found: types.Type
    if "named" in code or "tuple" in code:
        parts = [decode(one) for one in code["of" if "named" in code else "tuple"]]
        found = _types.BaseTuple.from_types(
            parts, _class_of(code["named"]) if "named" in code else None
        )
    elif "literal" in code:
        found = _types.literal(code["literal"])
    elif "omitted" in code:
        found = _types.Omitted(code["omitted"])
    else:
        raise MalformedError(f"{code} is no code of a type")
    return found


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
