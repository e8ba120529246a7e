"""OSC bundles as templates: python-osc builds one once, and each frame overwrites the numbers in it.

Only the types that every receiver reads: `i` int32, `f` float32, `s` string. python-osc takes a millisecond to build the
bundle of a body, `struct.pack_into` some microseconds to fill it.
"""

from collections.abc import Sequence

from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.parsing.osc_types import get_string

MAX_DATAGRAM_BYTES = 1472  # UDP payload of one unfragmented IPv4 packet at an MTU of 1500

_HEADER_BYTES = 16  # of a bundle: its name and the time tag
_SIZE_BYTES = 4  # before each message

Argument = int | float | str


def truncate_utf8(text: str, max_bytes: int) -> str:
    """The longest beginning of the text within `max_bytes` of UTF-8, cut between characters.

    A lone surrogate or NUL, which UTF-8 or OSC cannot hold, becomes `?`.
    """
    data = text.replace("\0", "?").encode(errors="replace")
    return data[:max_bytes].decode(errors="ignore")


def message(address: str, types: str, *arguments: Argument) -> OscMessage:
    """One message; `types` has one of `i f s` per argument, so that 1.0 is never sent as the integer 1."""
    builder = OscMessageBuilder(address)
    for kind, value in zip(types, arguments, strict=True):
        builder.add_arg(value, kind)
    return builder.build()


def numbers_offset(of: OscMessage) -> int:
    """Offset of the message's first number [bytes]; strings may precede it."""
    _, at = get_string(of.dgram, 0)
    types, at = get_string(of.dgram, at)
    for kind in types[1:]:
        if kind != "s":
            break
        _, at = get_string(of.dgram, at)
    return at


def bundle_size(messages: Sequence[OscMessage]) -> int:
    """Length of the bundle of these messages [bytes]."""
    return _HEADER_BYTES + sum(_SIZE_BYTES + element.size for element in messages)


def bundle(messages: Sequence[OscMessage]) -> tuple[bytearray, tuple[int, ...]]:
    """One bundle, and the offset of each message's numbers in it [bytes].

    Its time tag means "immediately": a later one would let receivers delay it.
    """
    builder = OscBundleBuilder(IMMEDIATELY)
    for element in messages:
        builder.add_content(element)
    offsets = [
        bundle_size(messages[:index]) + _SIZE_BYTES + numbers_offset(element)
        for index, element in enumerate(messages)
    ]
    return bytearray(builder.build().dgram), tuple(offsets)
