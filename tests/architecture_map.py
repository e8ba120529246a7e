"""The map of all modules, docs/modules.md, from the first line of every module's docstring.

`python -m tests.architecture_map` writes it anew; a test compares.
"""

import ast
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "modules.md"
HEAD = [
    "# Every module",
    "",
    "What each says of itself in its first line; made by `python -m tests.architecture_map`.",
]


def map_lines() -> list[str]:
    """One line a module, grouped by folder."""
    lines: list[str] = []
    folder = None
    for path in sorted((ROOT / "mocapd").rglob("*.py"), key=lambda p: (str(p.parent), p.name)):
        doc = ast.get_docstring(ast.parse(path.read_text())) or ""
        first = doc.strip().split("\n")[0]
        if path.parent != folder:
            folder = path.parent
            about = ast.get_docstring(ast.parse((folder / "__init__.py").read_text())) or ""
            lines += ["", f"**{folder.relative_to(ROOT)}/** {about.strip().splitlines()[0]}", ""]
        if path.name != "__init__.py":
            lines.append(f"- `{path.name}` {first}")
    return lines


def page() -> str:
    """The whole page."""
    return "\n".join([*HEAD, *map_lines()]) + "\n"


if __name__ == "__main__":
    PAGE.write_text(page())
