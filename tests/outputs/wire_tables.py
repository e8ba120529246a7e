"""The tables of docs/wire.md, from the structs themselves.

`python -m tests.outputs.wire_tables` writes them into the page; a test compares.
"""

import re
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, Union, get_args, get_origin, get_type_hints

import msgspec

from mocapd.outputs import messages, schemas, wire
from mocapd.outputs.osc import osc_frame

PAGE = Path(__file__).resolve().parents[2] / "docs" / "wire.md"
STRUCTS: dict[str, type[msgspec.Struct]] = {
    **schemas.STRUCTS,
    "Joint": wire.Joint,
    "OutputHealth": messages.OutputHealth,
    "CalibratedCamera": messages.CalibratedCamera,
}
BLOCK = "<!-- table {name} -->\n{text}<!-- end of table -->"
WORDS = {str: "string", int: "int", float: "float"}


def type_words(kind: Any) -> str:
    if get_origin(kind) is tuple:
        items = get_args(kind)
        if items[-1] is Ellipsis:
            return f"list of {type_words(items[0])}"
        return f"{len(items)} {type_words(items[0])}s"
    if get_origin(kind) is dict:
        return f"map of {type_words(get_args(kind)[1])}"
    if get_origin(kind) in (Union, UnionType):
        return " or ".join("null" if one is NoneType else type_words(one) for one in get_args(kind))
    return WORDS.get(kind) or str(kind.__name__)


def struct_table(struct: type[msgspec.Struct]) -> str:
    rows = ["| field | type | meaning |", "|---|---|---|"]
    plain = get_type_hints(struct)
    for name, hint in get_type_hints(struct, include_extras=True).items():
        rows.append(
            f"| `{name}` | {type_words(plain[name])} | {hint.__metadata__[-1].description} |"
        )
    return "\n".join(rows) + "\n"


def osc_table(arguments: tuple[tuple[str, str, str], ...]) -> str:
    rows = ["| argument | type | meaning |", "|---|---|---|"]
    rows += [f"| {name} | `{kind}` | {what} |" for name, kind, what in arguments]
    return "\n".join(rows) + "\n"


def tables() -> dict[str, str]:
    """Name of the table to its Markdown."""
    return {name: struct_table(struct) for name, struct in STRUCTS.items()} | {
        osc_frame.FRAME: osc_table(osc_frame.FRAME_ARGUMENTS),
        osc_frame.JOINT: osc_table(osc_frame.JOINT_ARGUMENTS),
    }


def page_with_tables(page: str) -> str:
    """The page with every table as the structs say. Raises KeyError for a table it has not."""
    for name, text in tables().items():
        block = BLOCK.format(name=name, text=text)
        empty = re.escape(f"<!-- table {name} -->") + r"\n.*?<!-- end of table -->"
        page, found = re.subn(empty, block.replace("\\", r"\\"), page, flags=re.DOTALL)
        if found != 1:
            raise KeyError(name)
    return page


if __name__ == "__main__":
    PAGE.write_text(page_with_tables(PAGE.read_text()))
