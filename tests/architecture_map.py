"""The map of all modules: `python -m tests.architecture_map` prints the first line of every module's docstring."""

import ast
import sys
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


@cache
def first_lines() -> dict[Path, str]:
    """By path within the project; a folder's is that of its `__init__.py`. Empty where there is none."""
    found = {}
    modules = (*(ROOT / "mocapd").rglob("*.py"), *(ROOT / "lab").rglob("*.py"))
    for path in sorted(modules, key=lambda p: (str(p.parent), p.name)):
        doc = ast.get_docstring(ast.parse(path.read_text())) or ""
        found[path.relative_to(ROOT)] = doc.strip().split("\n")[0]
    return found


def text() -> str:
    """One line a module, grouped by folder."""
    lines = []
    for path, first in first_lines().items():
        is_folder = path.name == "__init__.py"
        lines.append(f"\n{path.parent}/  {first}" if is_folder else f"  {path.name}  {first}")
    return "\n".join(lines).lstrip() + "\n"


if __name__ == "__main__":
    sys.stdout.write(text())
