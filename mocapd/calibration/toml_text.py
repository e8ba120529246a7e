"""Readable TOML: a row of numbers on one line, and no key without a value."""

import re
from collections.abc import Mapping
from typing import Any

import tomli_w

_ITEM = r"(?:[-+.0-9eE]+|true|false)"
_ROW = re.compile(rf"\[\n\s+({_ITEM}(?:,\s+{_ITEM})*),?\s+\]")


def toml_text(tables: Mapping[str, Any]) -> str:
    """The text of a TOML file; None is left out, as TOML has no null."""
    text = tomli_w.dumps(_without_none(tables))
    return _ROW.sub(lambda found: "[" + ", ".join(re.split(r",\s+", found[1])) + "]", text)


def _without_none(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _without_none(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [_without_none(item) for item in value]
    return value
