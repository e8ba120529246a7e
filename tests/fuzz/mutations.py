"""Mutations of inputs: damaged bytes, nasty values in a text, one token repeated many times, messages out of order."""

import math
import re
import struct
from collections.abc import Callable, Sequence
from random import Random
from typing import TypeVar

T = TypeVar("T")

_BYTES = (0x00, 0x01, 0x7F, 0x80, 0xFE, 0xFF, 0x0A, 0x22, 0x2C, 0x5B, 0x7B)
_NUMBERS = (0, 1, 0x7F, 0x80, 0xFF, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFF000000)
_NUMBERS_64 = (0xFFFFFFFF, 0x7FFFFFFFFFFFFFFF, 0x8000000000000000, 0xFFFFFFFFFFFFFFFF)
_CHUNKS = (
    b"\x00",
    b"\xff",
    b"\xed\xa0\x80",  # half of a surrogate pair
    b"\xef\xbb\xbf",
    b"\xc0\xaf",
    b"%s%n",
    b"\r\n\r\n",
    b"../" * 20,
    "é".encode(),
    "\u202e\U0001f600".encode(),
    b"9" * 400,
    b"A" * 5000,
)
_MOST_REPEATED_BYTES = 400_000  # S5, S8: 36 kB of dotted keys took 15 s, 25 kB of messages 300 s
_DIGITS = "9" * 5000  # Python reads 4,300
_LONG = "x" * 100_000
_DEEP = 3000

# What a value of JSON or TOML may be replaced by, as text
NUMBERS = (
    "0", "-0", "-1", "1", "3", "0.0", "-0.5", "1e308", "-1e308", "1e-320", "5e-324", "2147483648",
    "-2147483649", "9223372036854775807", "9223372036854775808", "-9223372036854775809",
    "18446744073709551616", "1" + "0" * 400, "-1" + "0" * 400, _DIGITS, f"-{_DIGITS}",
    "1." + _DIGITS, "1e400", "-1e400", "1e-400", "1000000000000", "65536", "20000", "1e9",
)  # fmt: skip
STRINGS = (
    '""', '" "', '"\\u0000"', '"\\ud800"', '"\\udfff\\ud800"', '"é"', '"\\u202e"', '"../../../etc/passwd"',
    '"/dev/zero"', '"/"', '"."', '"~nosuchuser/x"', '"%00"', f'"{_LONG}"', f'"{"x" * 300}"', '"nan"', '"1e400"',
    '"true"', '"-"', '"fifo"', '"a\\nb"', '"usb:1-1:046d:0825:x"', '"sim:living_room#left"',
)  # fmt: skip
JSON_VALUES = (
    *NUMBERS, *STRINGS, "NaN", "Infinity", "-Infinity", "true", "false", "null", "[]", "{}", "[[]]", "[null]",
    "[[[0]]]", '{"a":1}', '{"":{"":[]}}', "[1,2]", "[1,2,3,4,5,6]", '["x","y"]', "[" + "0," * 5000 + "0]",
    "[" * _DEEP + "]" * _DEEP, '{"a":' * _DEEP + "1" + "}" * _DEEP, "[" * 40 + "]" * 40, "[" * _DEEP,
)  # fmt: skip
TOML_VALUES = (
    *NUMBERS, *STRINGS, "nan", "inf", "-inf", "true", "false", "[]", "{}", "[[]]", "[[[0]]]", "{a = 1}",
    "[1, 2]", "[1, 2, 3, 4, 5, 6]", "['x', 'y']", "0xffffffffffffffffff", "0o777", "1979-05-27T07:32:00Z",
    "1979-05-27", "07:32:00", "9999-12-31T23:59:59.999999-23:59", "'''x\ny'''", '"""\\u0000"""',
    "[" + "0," * 5000 + "0]", "[" * _DEEP + "]" * _DEEP, "{a=" * _DEEP + "1" + "}" * _DEEP,
    "[" * 40 + "]" * 40, "{a=" * 40 + "1" + "}" * 40, "[" * _DEEP,
)  # fmt: skip
TOML_LINES = (
    f"{'.'.join('a' * 600)} = 1", f"[{'.'.join('b' * 600)}]", "[[camera]]", "[camera]", "schema = 1", "= 1",
    "[]", "a = 1\na = 2", '"" = 1', '"\\u0000" = 1', f"{'k' * 50_000} = 1", "# \u202e",
)  # fmt: skip

_SCALAR = re.compile(
    rb'"(?:[^"\\]|\\.)*"|\d{4}-\d\d-\d\dT[\d:.]+Z?|[-+]?\b\d[\d.eE+\-]*|\b(?:true|false|null)\b'
)
_TOKEN = re.compile(rb"\w+|\s+|[^\w\s]")
_WHOLE = {0x5B: 0x5D, 0x7B: 0x7D}  # brackets


def damaged(random: Random, data: bytes) -> bytes:
    """One to six changes of bytes: flipped, set, cut, put in, doubled, moved, or read as a number."""
    out = bytearray(data)
    for _ in range(1 + int(random.expovariate(0.8)) % 6):
        _DAMAGES[random.randrange(len(_DAMAGES))](random, out)
    return bytes(out)


def mistyped(
    random: Random, text: bytes, values: Sequence[str], lines: Sequence[str] = ()
) -> bytes:
    """A text of JSON or TOML in which some values are nasty ones, or lines or bytes are damaged.

    lines: that may be put in between.
    """
    for _ in range(1 + int(random.expovariate(1.2)) % 4):
        kind = random.random()
        if kind < 0.62:
            text = _with_value(random, text, random.choice(values))
        elif kind < 0.72:
            text = _without_brackets(random, text, random.choice(values))
        elif kind < 0.82:
            text = _lines(random, text, lines)
        else:
            text = damaged(random, text)
    return text


def repeated(
    random: Random,
    data: bytes,
    tokens: Sequence[bytes] = (),
    most_bytes: int = _MOST_REPEATED_BYTES,
) -> bytes:
    """The input with one token repeated in place, so often that it grows by up to `most_bytes`.

    The token is one to four neighbouring tokens of a text (`a.`, `{"a":`, `[],`), 1 to 64 bytes of
    anything, or, half the time, one of `tokens`: what a format repeats, such as an empty segment of a JPEG.
    The number of repetitions is log-uniform, since costs that grow quadratically show at the upper end only.
    """
    begin, end = _token_span(random, data)
    token = random.choice(tokens) if tokens and random.random() < 0.5 else data[begin:end]
    if not token:
        return data
    most = max(1, most_bytes // len(token))
    count = max(1, round(math.pow(most, random.random())))
    return data[:begin] + token * count + data[begin:]


def shuffled(
    random: Random, messages: Sequence[T], change: Callable[[Random, T], T], most: int = 40
) -> list[T]:
    """A sequence of 1 to `most` messages: `messages` in any order, repeated, left out, some of them changed."""
    out: list[T] = []
    length = 1 + random.randrange(most)
    while len(out) < length:
        one = random.choice(messages)
        if random.random() < 0.3:
            one = change(random, one)
        out += [one] * (1 if random.random() < 0.7 else random.randint(2, most))
    return out[:length]


def _token_span(random: Random, data: bytes) -> tuple[int, int]:
    """Begin and end of what is repeated."""
    begin = random.randint(0, len(data))
    if random.random() < 0.3:
        return begin, begin + random.randint(1, 64)
    end = begin
    for _ in range(random.randint(1, 4)):
        match = _TOKEN.match(data, end)
        if match is None:
            break
        end = match.end()
    return begin, end


def _with_value(random: Random, text: bytes, value: str) -> bytes:
    places = [found.span() for found in _SCALAR.finditer(text)]
    if not places:
        return text + value.encode()
    begin, end = random.choice(places)
    return text[:begin] + value.encode() + text[end:]


def _without_brackets(random: Random, text: bytes, value: str) -> bytes:
    """A whole list or table is the value."""
    begins = [i for i, one in enumerate(text) if one in _WHOLE]
    if not begins:
        return text
    begin = random.choice(begins)
    opening, depth = text[begin], 0
    for end in range(begin, len(text)):
        depth += (text[end] == opening) - (text[end] == _WHOLE[opening])
        if depth == 0:
            return text[:begin] + value.encode() + text[end + 1 :]
    return text[:begin] + value.encode()


def _lines(random: Random, text: bytes, new: Sequence[str]) -> bytes:
    """A line is left out, doubled or moved, or a new one is put in."""
    lines = text.split(b"\n")
    if new and random.random() < 0.5:
        lines.insert(random.randint(0, len(lines)), random.choice(new).encode())
        return b"\n".join(lines)
    line = lines.pop(random.randrange(len(lines)))
    for _ in range(random.randrange(3)):
        lines.insert(random.randint(0, len(lines)), line)
    return b"\n".join(lines)


def _flip(random: Random, out: bytearray) -> None:
    if out:
        out[random.randrange(len(out))] ^= 1 << random.randrange(8)


def _set(random: Random, out: bytearray) -> None:
    if out:
        out[random.randrange(len(out))] = random.choice((*_BYTES, random.randrange(256)))


def _cut_short(random: Random, out: bytearray) -> None:
    del out[random.randint(0, len(out)) :]


def _cut_out(random: Random, out: bytearray) -> None:
    begin = random.randint(0, len(out))
    del out[begin : begin + random.choice((1, 2, 4, 16, len(out) // 4))]


def _put_in(random: Random, out: bytearray) -> None:
    at = random.randint(0, len(out))
    out[at:at] = random.choice((*_CHUNKS, random.randbytes(random.randint(1, 16))))


def _double(random: Random, out: bytearray) -> None:
    begin, at = random.randint(0, len(out)), random.randint(0, len(out))
    out[at:at] = out[begin : begin + random.choice((1, 4, 16, 64, 1024))]


def _overwrite(random: Random, out: bytearray) -> None:
    """A stretch of it somewhere else."""
    begin, at = random.randint(0, len(out)), random.randint(0, len(out))
    stretch = out[begin : begin + random.choice((2, 8, 64))]
    out[at : at + len(stretch)] = stretch


def _number(random: Random, out: bytearray) -> None:
    """2, 4 or 8 bytes as a number that lengths and sizes do not expect."""
    order, kind = random.choice("<>"), random.choice("HIQ")
    size = struct.calcsize(kind)
    if len(out) >= size:
        at = random.randint(0, len(out) - size)
        value = random.choice((*_NUMBERS, *_NUMBERS_64)) & ((1 << 8 * size) - 1)
        out[at : at + size] = struct.pack(order + kind, value)


_DAMAGES = (_flip, _flip, _set, _cut_short, _cut_out, _put_in, _double, _overwrite, _number)
