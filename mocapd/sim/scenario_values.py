"""The values that scenario files are made of: numbers within what a camera shows, names, colours, frozen tables."""

from collections.abc import Sequence
from typing import Annotated

import msgspec

# in metres, degrees, seconds or signal: what is beyond these limits is no room that a camera shows
Number = Annotated[float, msgspec.Meta(ge=-1e4, le=1e4)]
Vec2 = tuple[Number, Number]
Vec3 = tuple[Number, Number, Number]
Srgb = tuple[
    Annotated[int, msgspec.Meta(ge=0, le=255)],
    Annotated[int, msgspec.Meta(ge=0, le=255)],
    Annotated[int, msgspec.Meta(ge=0, le=255)],
]
Positive = Annotated[float, msgspec.Meta(ge=1e-6, le=1e4)]
NotNegative = Annotated[float, msgspec.Meta(ge=0.0, le=1e4)]
Fraction = Annotated[float, msgspec.Meta(ge=0.0, le=1.0)]
Ratio = Annotated[float, msgspec.Meta(ge=0.7, le=1.4)]
Name = Annotated[str, msgspec.Meta(pattern=r"^[A-Za-z0-9_-]+$", max_length=100)]
Pixels = Annotated[int, msgspec.Meta(ge=16, le=8192)]


class Table(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of the file: frozen, and a key that is not a field is an error."""


class Span(Table, frozen=True, kw_only=True):
    """A part of the loop."""

    from_s: NotNegative
    to_s: Positive


def within(spans: Sequence[Span], t_s: float) -> bool:
    """Whether a time of the loop lies in one of its parts."""
    return any(span.from_s <= t_s < span.to_s for span in spans)
