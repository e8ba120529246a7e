"""Saturating counters in messages: every message can be encoded.

msgpack and JSON hold integers up to 64 bits, JavaScript and Godot up to 2^53; Python's have no limit.
"""

from functools import cache
from typing import Annotated, Any, get_type_hints

import msgspec
from msgspec import Meta

MOST_COUNT = 2**53  # the largest integer that every receiver holds exactly

_COUNT = Meta(ge=0, le=MOST_COUNT)
Count = Annotated[int, _COUNT]


class CountingMessage(msgspec.Struct, frozen=True):
    """Base of messages with counters: each field of type `Count` is limited to 0 … MOST_COUNT when the message is
    made. A received message that exceeds it is malformed."""

    def __post_init__(self) -> None:
        for name in _counters(type(self)):
            count = getattr(self, name)
            if not 0 <= count <= MOST_COUNT:
                msgspec.structs.force_setattr(self, name, min(max(0, count), MOST_COUNT))


@cache
def _counters(kind: type[msgspec.Struct]) -> tuple[str, ...]:
    """Names of the fields of type `Count`."""
    hints: dict[str, Any] = get_type_hints(kind, include_extras=True)
    return tuple(
        name for name, hint in hints.items() if _COUNT in getattr(hint, "__metadata__", ())
    )
