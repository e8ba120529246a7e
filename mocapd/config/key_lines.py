"""On which lines of a TOML text its keys stand."""

import re
from collections.abc import Iterator

_LONGEST_KEY = 200  # characters of a line in which a key and its `=` are looked for
_PREFIX_END = re.compile(r"[.\[]")


class KeyLines:
    """An index made once: a lookup takes no time that grows with the text."""

    def __init__(self, text: str) -> None:
        self._first: dict[str, int] = {}  # by key and by each prefix of a key
        self._last: dict[str, int] = {}  # by whole key
        for number, path in _keys(text):
            self._last[path] = number
            for prefix in _prefixes(path):
                self._first.setdefault(prefix, number)

    def line_of(self, key: str) -> int | None:
        """The line where a key such as "camera[1].fps" is set, or its section begins; None when neither is found."""
        if key in self._first:
            return self._first[key]
        found = [self._last[prefix] for prefix in _prefixes(key) if prefix in self._last]
        return max(found, default=None)


def _prefixes(path: str) -> list[str]:
    """The path itself and what stands before each of its dots and brackets."""
    return [path, *(path[: found.start()] for found in _PREFIX_END.finditer(path))]


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
