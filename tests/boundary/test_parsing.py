"""What cannot be read has one name, whatever the libraries call it."""

import math

import msgspec
import pytest

from mocapd.boundary import parsing
from mocapd.errors import MalformedError


class Command(msgspec.Struct):
    verb: str
    args: dict[str, object] = {}


@pytest.mark.parametrize(
    "data",
    [
        b"",
        b"{",
        b'{"verb": 1}',
        b'{"verb": "\xff"}',
        b'{"verb": "go", "args": ' + b"[" * 2000 + b"]" * 2000 + b"}",
        b'{"verb": "go", "args": {"a": ' + b"[" * 100 + b"]" * 100 + b"}}",
        b'{"verb": "go", "args": {"a": ' + b"9" * 5000 + b"}}",
    ],
)
def test_a_bad_json_message_is_malformed(data: bytes) -> None:
    with pytest.raises(MalformedError):
        parsing.decode_json(data, Command)


def test_a_good_json_message_is_its_value() -> None:
    got = parsing.decode_json(b'{"verb": "go", "args": {"a": [[1], [2]]}}', Command)
    assert got == Command("go", {"a": [[1], [2]]})


@pytest.mark.parametrize("data", [b"", b"\x91" * 100_000, b"\xd9\x05abc", b"\x81\xa1\xff\x01"])
def test_bad_msgpack_is_malformed(data: bytes) -> None:
    with pytest.raises(MalformedError):
        parsing.decode_msgpack(data, Command)


@pytest.mark.parametrize(
    "text", ["{", '{"a": ' + "9" * 5000 + "}", "[" * 100_000, "[" * 40 + "]" * 40]
)
def test_a_bad_json_file_is_malformed(text: str) -> None:
    with pytest.raises(MalformedError):
        parsing.parse_json(text)


@pytest.mark.parametrize(
    "text",
    ["a =", "a = " + "9" * 5000, "a = " + "[" * 5000, ".".join("a" * 600) + " = 1.0"],
)
def test_a_bad_toml_file_is_malformed(text: str) -> None:
    with pytest.raises(MalformedError):
        parsing.parse_toml(text)


@pytest.mark.parametrize(
    "text",
    [
        "a." * 12_000 + "a = 1",
        "x = 1\n[" + "a." * 12_000 + "a]",
        "x = [[{" + "a ." * 12_000 + "a = 1}]]",
        "x = 1\n" + '\'=\'."\\".,".' * 12_000 + "a = 1",
        # a multi-line text ends in the middle of a line
        'x = ["""\n#""", {' + "a." * 12_000 + "a = 1}]",
    ],
)
def test_a_dotted_key_of_many_parts_is_refused_before_it_is_parsed(text: str) -> None:
    with pytest.raises(MalformedError, match="a key of more than 32 parts"):
        parsing.parse_toml(text)


def test_a_dotted_key_of_few_parts_is_read() -> None:
    assert parsing.parse_toml("'a=1'.b.\"c.d\" = [1.5, 2.5]") == {"a=1": {"b": {"c.d": [1.5, 2.5]}}}


def test_the_place_of_a_mistake_in_toml_is_told() -> None:
    with pytest.raises(MalformedError, match="line 2"):
        parsing.parse_toml("a = 1\nb = ?\n")


@pytest.mark.parametrize("tree", [{}, {"verb": 10**400}, {"verb": math.inf}])
def test_a_tree_of_another_form_is_malformed(tree: object) -> None:
    with pytest.raises(MalformedError):
        parsing.convert(tree, Command)
