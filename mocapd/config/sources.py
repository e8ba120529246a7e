"""Where values come from: a TOML file with line numbers, the environment, flags."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mocapd.boundary.files import MissingError, read_text
from mocapd.boundary.messages import parse_toml
from mocapd.errors import ConfigError, InputError, MalformedError

_MOST_BYTES = 1 << 20
_LONGEST_KEY = 200  # characters of a line in which a key and its `=` are looked for
ENV_PREFIX = "MOCAPD_"
# Read elsewhere, not keys: which file to read, and what .ci/run tells the tests.
NOT_KEYS = ("MOCAPD_CONFIG", "MOCAPD_REQUIRE_SHARED")


@dataclass(frozen=True, slots=True)
class TomlFile:
    """A parsed file that can say on which line a key stands."""

    path: Path
    data: Mapping[str, Any]
    text: str

    def where(self, key: str) -> str:
        """`file:line` of a key's path such as "zenoh.port" or "camera[1].fps"; the file if unsure."""
        line = _line_of(self.text, key)
        return f"{self.path}:{line}" if line else str(self.path)


def read_toml(path: Path) -> TomlFile:
    """Raises InputError when it cannot be read, ConfigError with the line when it is not TOML."""
    try:
        text = read_text(path, _MOST_BYTES)
    except MissingError:
        raise InputError("no such config file", str(path), "check the path") from None
    except InputError as error:
        raise InputError(f"the config file {error.what}", str(path), error.fix) from None
    try:
        return TomlFile(path, parse_toml(text), text)
    except MalformedError as error:
        found = re.search(r"at line (\d+)", error.what)
        where = f"{path}:{found[1]}" if found else str(path)
        raise ConfigError(f"not valid TOML ({error.what})", where, "mend that line") from None


def env_name(path: str) -> str:
    """The variable of a key: "zenoh.port" is MOCAPD_ZENOH_PORT."""
    return ENV_PREFIX + path.replace(".", "_").upper()


def parsed(text: str, wants_text: bool) -> Any:
    """A value from a flag or a variable: TOML, except that text needs no quotes."""
    if wants_text and not text.startswith(("[", '"', "'")):
        return text
    try:
        return parse_toml(f"value = {text}")["value"]
    except MalformedError:
        return text


def _line_of(text: str, key: str) -> int | None:
    """The line where a key is set, or its section begins; None when the scan finds neither."""
    section, counts = "", dict[str, int]()
    best = None
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
            path = section
        elif assigned:
            name = re.sub(r"[\s\"']", "", assigned[1])
            path = f"{section}.{name}" if section else name
        else:
            continue
        if path == key or path.startswith((f"{key}.", f"{key}[")):
            return number
        if key.startswith((f"{path}.", f"{path}[")):
            best = number
    return best
