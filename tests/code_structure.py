"""Figures of the code's structure: `python -m tests.code_structure` prints them; `make check` runs it.

Exits with 1 on a circle of imports, a class name that is there twice in the package, and a dead link. Module names that
are there twice and long files are printed only.
"""

import ast
import re
import sys
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import grimp

ROOT = Path(__file__).resolve().parents[1]
LONGEST_LINES = 350
_LINK = re.compile(r"\]\(([^)#:\s]+)(?:#[^)\s]*)?\)")
_DOCS_PAGE = re.compile(r"(?<![\w/.])docs/[\w/-]+\.md")


@dataclass(frozen=True, slots=True)
class Structure:
    """What was found below one root; every line is ready for people."""

    rooms: tuple[str, ...]
    circles: tuple[str, ...]
    dead_links: tuple[str, ...]
    classes_twice: tuple[str, ...]
    modules_twice: tuple[str, ...]
    long_files: tuple[str, ...]

    @property
    def is_sound(self) -> bool:
        return not (self.circles or self.dead_links or self.classes_twice)

    def text(self) -> str:
        parts = (
            ("circles of imports", self.circles),
            ("dead links", self.dead_links),
            ("class names twice", self.classes_twice),
            ("module names twice", self.modules_twice),
            (f"files over {LONGEST_LINES} lines", self.long_files),
        )
        lines = [f"rooms: {len(self.rooms)}", *(f"  {room}" for room in self.rooms)]
        for name, found in parts:
            lines += [f"{name}: {len(found)}", *(f"  {one}" for one in found)]
        return "\n".join(lines)


def structure_of(root: Path, imports: Mapping[str, set[str]]) -> Structure:
    """Of the package `mocapd` and the pages below `root`; imports: by module those that it imports."""
    package = root / "mocapd"
    modules = {path: path.read_text("utf-8") for path in sorted(package.rglob("*.py"))}
    rooms: defaultdict[str, list[int]] = defaultdict(list)
    for path, text in modules.items():
        rooms[path.relative_to(package).parts[0]].append(text.count("\n"))
    return Structure(
        tuple(
            f"{name} {len(lines)} modules, {sum(lines)} lines"
            for name, lines in sorted(rooms.items())
            if not name.endswith(".py")
        ),
        tuple(" -> ".join(circle) for circle in circles(imports)),
        tuple(sorted(_dead_links(root))),
        _twice((name, path) for path, text in modules.items() for name in _classes(text)),
        _twice((path.name, path) for path in modules if path.name != "__init__.py"),
        tuple(
            f"{path.relative_to(root)} {text.count(chr(10))}"
            for path, text in modules.items()
            if text.count("\n") > LONGEST_LINES
        ),
    )


def circles(imports: Mapping[str, set[str]]) -> list[list[str]]:
    """A shortest circle through each module that is on one and on none of those before; begins and ends with it."""
    found: list[list[str]] = []
    known: set[str] = set()
    for start in sorted(imports):
        came_from: dict[str, str] = {}
        queue = [start]
        for module in queue:  # which grows: breadth first
            for other in sorted(imports.get(module, ())):
                if other not in came_from:
                    came_from[other] = module
                    queue.append(other)
        if start not in came_from or start in known:
            continue
        circle = [start, came_from[start]]
        while circle[-1] != start:
            circle.append(came_from[circle[-1]])
        found.append(circle[::-1])
        known.update(circle)
    return found


def package_imports() -> dict[str, set[str]]:
    """By module of `mocapd` and `lab` what it imports of them, those for type checkers left out."""
    graph = grimp.build_graph("mocapd", "lab", exclude_type_checking_imports=True, cache_dir=None)
    return {module: graph.find_modules_directly_imported_by(module) for module in graph.modules}


def _classes(text: str) -> Iterator[str]:
    """Public classes of a module; a private one, and `Params`, which every part has, belong to their module."""
    for node in ast.parse(text).body:
        if (
            isinstance(node, ast.ClassDef)
            and not node.name.startswith("_")
            and node.name != "Params"
        ):
            yield node.name


def _twice(named: Iterator[tuple[str, Path]]) -> tuple[str, ...]:
    counts = Counter(name for name, _ in named)
    return tuple(f"{name} {count} times" for name, count in sorted(counts.items()) if count > 1)


def _dead_links(root: Path) -> Iterator[str]:
    """Links of pages, and pages of docs/ that modules name."""
    pages = [*root.glob("*.md")]
    for folder in ("docs", "mocapd", "lab", "locks", "clients", "tests"):
        pages += (root / folder).rglob("*.md")
    for page in pages:
        if "node_modules" in page.parts:
            continue
        for link in _LINK.findall(page.read_text("utf-8")):
            if not (page.parent / link).exists():
                yield f"{page.relative_to(root)}: {link}"
    for folder in ("mocapd", "lab"):
        for module in (root / folder).rglob("*.py"):
            for link in _DOCS_PAGE.findall(module.read_text("utf-8")):
                if not (root / link).exists():
                    yield f"{module.relative_to(root)}: {link}"


if __name__ == "__main__":
    FOUND = structure_of(ROOT, package_imports())
    sys.stdout.write(FOUND.text() + "\n")
    sys.exit(not FOUND.is_sound)
