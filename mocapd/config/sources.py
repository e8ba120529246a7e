"""Sources of values: a TOML file with line numbers, the environment, flags."""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mocapd.boundary.files import MissingError, read_text
from mocapd.boundary.parsing import parse_toml
from mocapd.errors import ConfigError, InputError, MalformedError

_MOST_BYTES = 64_000  # a file that sets every key takes some kB
ENV_PREFIX = "MOCAPD_"
# Variables that are no keys: the path of the file, and a switch of the tests.
NOT_KEYS = ("MOCAPD_CONFIG", "MOCAPD_REQUIRE_SHARED")


_LONGEST_KEY = 200  # characters of a line in which a key and its `=` are looked for
_PREFIX_END = re.compile(r"[.\[]")


class KeyLines:
    """Line numbers of the keys in a TOML text: a look-up takes constant time."""

    def __init__(self, text: str) -> None:
        self._first: dict[str, int] = {}  # by key and by each prefix of a key
        self._last: dict[str, int] = {}  # by whole key
        for number, path in _keys(text):
            self._last[path] = number
            for prefix in _prefixes(path):
                self._first.setdefault(prefix, number)

    def line_of(self, key: str) -> int | None:
        """The line of a key such as "camera[1].fps", else of its section; None when neither is found."""
        if key in self._first:
            return self._first[key]
        lines = [self._last[prefix] for prefix in _prefixes(key) if prefix in self._last]
        return max(lines, default=None)


def _prefixes(path: str) -> list[str]:
    """The path, and its prefixes before each dot and bracket."""
    return [path, *(path[: end.start()] for end in _PREFIX_END.finditer(path))]


def _keys(text: str) -> Iterator[tuple[int, str]]:
    """Line numbers from 1, and the path of the section or key that the line sets."""
    section, counts = "", dict[str, int]()
    for number, whole in enumerate(text.splitlines(), start=1):
        line = whole.strip()[:_LONGEST_KEY]  # the patterns take quadratic time over blanks
        header = re.match(r"\s*(\[\[?)\s*([\w.\-\"' ]+?)\s*\]", line)
        assigned = re.match(r"\s*([\w.\-\"' ]+?)\s*=", line)
        if header:
            section = re.sub(r"[\s\"']", "", header[2])
            if header[1] == "[[":
                counts[section] = counts.get(section, -1) + 1
            head, _, rest = section.partition(".")
            if head in counts:  # also a table inside an entry of the list
                section = f"{head}[{counts[head]}]" + (f".{rest}" if rest else "")
            yield number, section
        elif assigned:
            name = re.sub(r"[\s\"']", "", assigned[1])
            yield number, f"{section}.{name}" if section else name


@dataclass(frozen=True, slots=True)
class TomlFile:
    """A parsed file with the line numbers of its keys."""

    path: Path
    data: Mapping[str, Any]
    lines: KeyLines

    def where(self, key: str) -> str:
        """`file:line` of a key's path such as "zenoh.port" or "camera[1].fps"; the file if unsure."""
        line = self.lines.line_of(key)
        return f"{self.path}:{line}" if line else str(self.path)


def read_toml(path: Path) -> TomlFile:
    """Reads a TOML file. Raises InputError when it cannot be read, ConfigError with the line for invalid TOML."""
    try:
        text = read_text(path, _MOST_BYTES)
    except MissingError:
        raise InputError("no such config file", str(path), "check the path") from None
    except InputError as error:
        raise InputError(f"the config file {error.what}", str(path), error.fix) from None
    try:
        return TomlFile(path, parse_toml(text), KeyLines(text))
    except MalformedError as error:
        line = re.search(r"at line (\d+)", error.what)
        where = f"{path}:{line[1]}" if line else str(path)
        raise ConfigError(f"not valid TOML ({error.what})", where, "mend that line") from None


def env_name(path: str) -> str:
    """The variable of a key: "zenoh.port" is MOCAPD_ZENOH_PORT."""
    return ENV_PREFIX + path.replace(".", "_").upper()


def parse_value(text: str, wants_text: bool) -> Any:
    """Parses a value of a flag or a variable: TOML, but text needs no quotes."""
    if wants_text and not text.startswith(("[", '"', "'")):
        return text
    try:
        return parse_toml(f"value = {text}")["value"]
    except MalformedError:
        return text
