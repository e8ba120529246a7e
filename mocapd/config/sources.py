"""Sources of values: a TOML file with line numbers, the environment, flags."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mocapd.boundary.files import MissingError, read_text
from mocapd.boundary.parsing import parse_toml
from mocapd.config.key_lines import KeyLines
from mocapd.errors import ConfigError, InputError, MalformedError

_MOST_BYTES = 64_000  # a file that sets every key takes some kB
ENV_PREFIX = "MOCAPD_"
# Variables that are no keys: the path of the file, and a switch of the tests.
NOT_KEYS = ("MOCAPD_CONFIG", "MOCAPD_REQUIRE_SHARED")


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
