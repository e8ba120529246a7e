"""OSC 1.0 bytes: strings, messages, bundles, and messages whose numbers are overwritten in place.

Only the types that every receiver reads: `i` int32, `f` float32, `s` string. Building a bundle from
objects takes a millisecond in Python; laid out once and overwritten it takes some microseconds.
Source: OSC 1.0 specification (opensoundcontrol.org).
"""

import struct
from collections.abc import Sequence

MAX_DATAGRAM_BYTES = 1472  # UDP payload of one unfragmented IPv4 packet at an MTU of 1500
IMMEDIATELY = (1).to_bytes(8, "big")  # a later time tag would let receivers hold the bundle back
BUNDLE_HEADER = b"#bundle\0" + IMMEDIATELY

Argument = int | float | str


def string(text: str) -> bytes:
    """NUL-terminated UTF-8, padded to a multiple of 4 bytes. What UTF-8 or OSC cannot hold is `?`."""
    data = text.replace("\0", "?").encode(errors="replace")
    return data + b"\0" * (4 - len(data) % 4)


def shortened(text: str, max_bytes: int) -> str:
    """The beginning of the text that takes at most so many bytes of UTF-8, without half characters."""
    return text.encode(errors="replace")[:max_bytes].decode(errors="ignore")


def message(address: str, types: str, *arguments: Argument) -> bytes:
    """One message; `types` has one of `i f s` per argument, so that 1 is never sent for 1.0."""
    parts = [string(address), string("," + types)]
    for kind, value in zip(types, arguments, strict=True):
        if kind == "s":
            parts.append(string(str(value)))
        else:
            parts.append(struct.pack(">" + kind, value))
    return b"".join(parts)


def arguments_offset(address: str, types: str) -> int:
    """Where in a message of this address and these types the first argument begins [bytes]."""
    return len(string(address)) + len(string("," + types))


def bundle_size(messages: Sequence[bytes]) -> int:
    """Length of the bundle of these messages [bytes]."""
    return len(BUNDLE_HEADER) + sum(4 + len(element) for element in messages)


def bundle(messages: Sequence[bytes]) -> tuple[bytearray, tuple[int, ...]]:
    """One bundle, to be executed immediately, and where in it each message begins [bytes]."""
    out = bytearray(BUNDLE_HEADER)
    offsets = []
    for element in messages:
        out += struct.pack(">i", len(element))
        offsets.append(len(out))
        out += element
    return out, tuple(offsets)
