"""Parses JSON, msgpack and TOML; every malformed input raises MalformedError.

The libraries raise a dozen kinds: msgspec its DecodeError, a UnicodeDecodeError or a
RecursionError, `int` a ValueError for more than 4,300 digits, and a parsed tree of 600 levels breaks recursive
functions. This module converts all of them.
"""

import json
import re
import tomllib
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

import msgspec

from mocapd.errors import MalformedError

T = TypeVar("T")

MOST_NESTED = 32  # levels of objects and lists; nothing of ours has more than 8
_LONGEST_REASON = 300  # characters of a parser's message

# A dotted TOML key of more than MOST_NESTED parts. tomllib takes quadratic time and memory over the
# parts. It also finds text that only looks like one, which no file of ours holds. Linear: no part
# gives anything back, and a key begins only behind a blank, a comma or an opening bracket.
_KEY_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
_LONG_KEY = re.compile(rf"(?<![^\s\[{{,])(?:{_KEY_PART}[ \t]*+\.[ \t]*+){{{MOST_NESTED}}}")


def decode_json(data: bytes | str, kind: type[T]) -> T:
    """A JSON message as `kind`. Raises MalformedError."""
    return _read(lambda: msgspec.json.decode(data, type=kind))


def decode_msgpack(data: bytes | memoryview, kind: type[T]) -> T:
    """A msgpack message as `kind`. Raises MalformedError."""
    return _read(lambda: msgspec.msgpack.decode(data, type=kind))


def parse_json(text: str) -> Any:
    """A JSON file's text; the reason of a failure names line and column. Raises MalformedError."""
    return _read(lambda: json.loads(text))


def parse_toml(text: str) -> dict[str, Any]:
    """A TOML file's text; the reason of a failure names line and column. Raises MalformedError."""
    long_key = _LONG_KEY.search(text)
    if long_key is not None:
        line = text.count("\n", 0, long_key.start()) + 1
        raise MalformedError(f"a key of more than {MOST_NESTED} parts (at line {line})")
    return _read(lambda: tomllib.loads(text))


def convert(tree: object, kind: Any, dec_hook: Callable[[type, Any], Any] | None = None) -> Any:
    """A parsed tree as `kind`, checked key by key. Raises MalformedError."""
    return _read(lambda: msgspec.convert(tree, kind, dec_hook=dec_hook))


def _read(parse: Callable[[], T]) -> T:
    try:
        tree = parse()
    # ValueError: among them UnicodeDecodeError, JSONDecodeError, TOMLDecodeError, too many digits
    except (msgspec.MsgspecError, ValueError, OverflowError) as error:
        raise MalformedError(str(error)[:_LONGEST_REASON]) from None
    except RecursionError:
        raise MalformedError("nested too deeply") from None
    _check_nesting(tree)
    return tree


def _check_nesting(tree: object) -> None:
    """Level by level, without recursion. Raises MalformedError."""
    level = [tree]
    for _ in range(MOST_NESTED):
        level = [item for node in level for item in _items(node) if isinstance(item, dict | list)]
        if not level:
            return
    raise MalformedError(f"nested more than {MOST_NESTED} levels deep")


def _items(one: object) -> Iterable[object]:
    if isinstance(one, dict):
        return one.values()
    if isinstance(one, list):
        return one
    if isinstance(one, msgspec.Struct):  # a free part of a message, such as a command's arguments
        return (getattr(one, name) for name in one.__struct_fields__)
    return ()
