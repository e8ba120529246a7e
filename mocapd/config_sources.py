"""Where values come from: a TOML file with line numbers, the environment, flags."""

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mocapd.errors import ConfigError, InputError

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
        text = path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise InputError("no such config file", str(path), "check the path") from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(
            f"the config file cannot be read ({error})", str(path), "check the path and its rights"
        ) from None
    try:
        return TomlFile(path, tomllib.loads(text), text)
    except tomllib.TOMLDecodeError as error:
        found = re.search(r"at line (\d+)", str(error))
        where = f"{path}:{found[1]}" if found else str(path)
        raise ConfigError(f"not valid TOML ({error})", where, "mend that line") from None


def env_name(path: str) -> str:
    """The variable of a key: "zenoh.port" is MOCAPD_ZENOH_PORT."""
    return ENV_PREFIX + path.replace(".", "_").upper()


def parsed(text: str, wants_text: bool) -> Any:
    """A value from a flag or a variable: TOML, except that text needs no quotes."""
    if wants_text and not text.startswith(("[", '"', "'")):
        return text
    try:
        return tomllib.loads(f"value = {text}")["value"]
    except tomllib.TOMLDecodeError:
        return text


def _line_of(text: str, key: str) -> int | None:
    """The line where a key is set, or its section begins; None when the scan finds neither."""
    section, counts = "", dict[str, int]()
    best = None
    for number, line in enumerate(text.splitlines(), start=1):
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
