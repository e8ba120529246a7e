"""OSC 1.0 as a proper library decodes it: every value with its tag, nested bundles opened.

For receivers whose trouble begins after decoding. Source: the OSC 1.0 specification; JavaOSC,
which is under SlimeVR, and UEOSC, which is under VMC4UE, know these tags.
"""

import struct
from dataclasses import dataclass

_NUMBERS = {"i": ">i", "f": ">f", "d": ">d", "h": ">q", "t": ">Q"}


@dataclass(frozen=True)
class TypedValue:
    """value: None where the tag says it all (T F N I)."""

    tag: str
    value: int | float | str | bytes | None


@dataclass(frozen=True)
class TypedMessage:
    """One message."""

    address: str
    values: tuple[TypedValue, ...]


def decoded(data: bytes) -> list[TypedMessage]:
    """The messages of a datagram. Raises ValueError or struct.error for anything that is no OSC."""
    if not data.startswith(b"#bundle\0"):
        return [_message(data)]
    messages, at = [], 16
    while at < len(data):
        (size,) = struct.unpack_from(">i", data, at)
        if size % 4 or at + 4 + size > len(data):
            raise ValueError(f"an element of {size} bytes")
        messages += decoded(data[at + 4 : at + 4 + size])
        at += 4 + size
    return messages


def _message(data: bytes) -> TypedMessage:
    address, at = _string(data, 0)
    tags, at = _string(data, at)
    if not address.startswith("/") or not tags.startswith(","):
        raise ValueError("no message")
    values = []
    for tag in tags[1:]:
        value: int | float | str | bytes | None = None
        if tag in _NUMBERS:
            (value,) = struct.unpack_from(_NUMBERS[tag], data, at)
            at += struct.calcsize(_NUMBERS[tag])
        elif tag == "s":
            value, at = _string(data, at)
        elif tag == "b":
            (size,) = struct.unpack_from(">i", data, at)
            value, at = data[at + 4 : at + 4 + size], at + 4 + (size + 3 & ~3)
        elif tag not in "TFNI":
            raise ValueError(f"tag {tag}")
        values.append(TypedValue(tag, value))
    if at != len(data):
        raise ValueError(f"{len(data) - at} bytes too many")
    return TypedMessage(address, tuple(values))


def _string(data: bytes, at: int) -> tuple[str, int]:
    end = data.index(b"\0", at)
    return data[at:end].decode(), at + (end - at + 4 & ~3)
