"""Finds the line numbers of the keys in a TOML text."""

import re
from collections.abc import Iterator

_LONGEST_KEY = 200  # characters of a line in which a key and its `=` are looked for
_PREFIX_END = re.compile(r"[.\[]")


class KeyLines:
    """Index of line numbers: a look-up takes constant time."""

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
