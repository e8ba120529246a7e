"""Every file that the documentation names is there, and every name that the modules' comments speak of."""

import ast
import keyword
import os
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


# each begins at the root of the checkout, or at the package
ROOMS = {p.name for p in (ROOT / "mocapd").iterdir() if p.is_dir()} - {"__pycache__"}
TOPS = ("mocapd", "docs", "tests", "calib", "clients", "deb", "lab", "locks", "systemd")
PAGES = (
    *ROOT.glob("*.md"),
    *(ROOT / "docs").rglob("*.md"),
    *(ROOT / "lab").rglob("*.md"),
    *(ROOT / "locks").rglob("*.md"),
    *(page for page in (ROOT / "clients").rglob("*.md") if "node_modules" not in page.parts),
    *(ROOT / "mocapd").rglob("*.md"),
)
MODULES = (*(ROOT / "mocapd").rglob("*.py"), *(ROOT / "lab").rglob("*.py"))

_PATH = re.compile(r"(?<![\w./~$<-])((?:[A-Za-z_][\w-]*/)+[\w.*<>-]*)")
_NAME = re.compile(r"`([\w]+\.(?:py|js|md))`")
_MODULE = re.compile(r"(?<![\w/.])(?:mocapd|lab)(?:\.[a-z_]\w*)+(?:\.[A-Z]\w*)?")
_LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")
_QUOTED = re.compile(r"`([A-Za-z_][\w.]*)(?:\(\))?`")
_COMMENT = re.compile(r"(?:^|  )#:? .*$", re.MULTILINE)
_SHORT = 60  # characters of a text that may be a key or a name, not prose


@cache
def files() -> frozenset[str]:
    """The names of the files in the checkout."""
    deep = (name for top in TOPS for _, _, names in os.walk(ROOT / top) for name in names)
    return frozenset(deep) | {p.name for p in ROOT.iterdir() if p.is_file()}


@cache
def nodes(path: Path) -> tuple[ast.AST, ...]:
    """The syntax tree of a module, flat. `ast.walk` takes three times as long."""
    flat: list[ast.AST] = [ast.parse(path.read_text())]
    for node in flat:  # which grows
        for value in vars(node).values():
            if isinstance(value, list):
                flat += [one for one in value if isinstance(one, ast.AST)]
            elif isinstance(value, ast.AST) and not isinstance(value, ast.expr_context):
                flat.append(value)
    return tuple(flat)


@cache
def remarks(path: Path) -> tuple[str, ...]:
    """The docstrings and the comments of a module."""
    documented = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    texts = [ast.get_docstring(node) or "" for node in nodes(path) if isinstance(node, documented)]
    return (*texts, *_COMMENT.findall(path.read_text()))


def names_in(path: Path) -> Iterator[str]:
    """Everything that the code of a module names: variables, functions, fields, modules, keys."""
    yield from (path.stem, path.parent.name)
    for node in nodes(path):
        for kind, value in vars(node).items():
            if not isinstance(value, str):
                continue
            if kind in ("id", "attr", "name", "arg", "module"):
                yield from value.split(".")
            elif kind == "value" and len(value) < _SHORT:  # of a constant
                yield from re.findall(r"\w+", value)


def missing(text: str, beside: Path) -> Iterator[str]:
    """What `text` names and is not there; `beside`: the folder that it may speak of."""
    for path in _PATH.findall(text):
        path = path.rstrip(".-")
        first = path.split("/")[0]
        if first not in (*TOPS, *ROOMS) or set("*<>") & set(path):
            continue
        places = (ROOT, ROOT / "mocapd", beside)
        if ("." in path or path.endswith("/")) and not any((p / path).exists() for p in places):
            yield path
    for name in _NAME.findall(text):
        if name not in files():
            yield name
    for module in _MODULE.findall(text):
        if not _is_module(module):
            yield module


@cache
def _is_module(dotted: str) -> bool:
    """Whether it begins with a module of the package or of the lab; what follows a module is a name in it."""
    here = ROOT
    for part in dotted.split("."):
        if (here / f"{part}.py").is_file():
            return True
        if not (here / part).is_dir():
            return (here / "__init__.py").is_file() and part in (here / "__init__.py").read_text()
        here = here / part
    return True


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_pages_name_files_that_are_there(page: Path) -> None:
    text = page.read_text()
    assert not list(missing(text, page.parent))
    links = [to for to in _LINK.findall(text) if not (page.parent / to).exists()]
    assert not links


def test_remarks_name_files_that_are_there() -> None:
    wrong = {
        str(path.relative_to(ROOT)): gone
        for path in MODULES
        if (gone := {one for text in remarks(path) for one in missing(text, path.parent)})
    }
    assert not wrong


def test_remarks_name_what_the_code_names() -> None:
    known = {name for path in MODULES for name in names_in(path)} | set(keyword.kwlist)
    for page in (ROOT / "mocapd" / "web" / "page").iterdir():
        known |= set(re.findall(r"\w+", page.read_text()))
    wrong = {
        str(path.relative_to(ROOT)): gone
        for path in MODULES
        if (
            gone := {
                quoted
                for text in remarks(path)
                for quoted in _QUOTED.findall(text)
                if not known.issuperset(quoted.split("."))
            }
        )
    }
    assert not wrong
