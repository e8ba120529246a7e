"""Configuration keys of a tree of frozen dataclasses: types, limits and defaults, read from the fields.

A section is a frozen dataclass; a field is a key, or another section, or a list of sections. Limits
are `msgspec.Meta` in `Annotated`, or the section's own `__post_init__`. The words for the user are
in the Meta, or a line `name: words` of the section's docstring.
"""

import difflib
import inspect
import json
import re
import types
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import MISSING, dataclass, fields, is_dataclass
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

from msgspec import Meta

from mocapd.boundary.numbers import brief, check_numbers
from mocapd.boundary.parsing import convert
from mocapd.boundary.urls import without_password
from mocapd.errors import ConfigError, MalformedError

COMMAND_LINE = "command line"  # the origin of an option's value
_MOST_SECTIONS = 100  # of one list; a calibration has at most 100 cameras
_LARGEST_BITS = 64  # of a whole number
_LONGEST_SHOWN = 200  # characters of a value in an error


@dataclass(frozen=True, slots=True)
class SectionTable:
    """Marks a field that holds sections by name, `Mapping[str, Any]`, for pluggable parts. In a file these sections are on
    the level of the field, not under the field's name."""

    sections: Callable[[], Mapping[str, Any]]

    def built(self, values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
        """Builds every section of the table from the values of keys by path."""
        table = self.sections().items()
        return {name: build(section, values, f"{prefix}{name}.") for name, section in table}


@dataclass(frozen=True, slots=True)
class Key:
    """One key. `default_text` replaces a machine-dependent default in the documentation."""

    path: str
    type: Any
    default: Any
    help: str
    default_text: str

    @property
    def wants_text(self) -> bool:
        """True if values of flags and variables are text and need no quotes."""
        bare = _bare(self.type)
        if get_origin(bare) is Literal:
            return all(isinstance(choice, str) for choice in get_args(bare))
        return bare in (str, Path)

    @property
    def is_path(self) -> bool:
        """True for a path of type str, by the extra of its Meta."""
        return bool((_meta(self.type).extra or {}).get("is_path"))


def keys_of(section: Any, prefix: str = "") -> Iterator[Key]:
    """Every key of a section and of the sections in it, in the order of the fields."""
    hints = get_type_hints(section, include_extras=True)
    words = _docstring_words(section)
    for field in fields(section):
        annotation, path = hints[field.name], prefix + field.name
        table = _table(annotation)
        if table is not None:
            for name, nested in table.sections().items():
                yield from keys_of(nested, f"{prefix}{name}.")
            continue
        if is_dataclass(annotation):
            yield from keys_of(annotation, f"{path}.")
            continue
        default = MISSING
        if field.default is not MISSING:
            default = field.default
        elif field.default_factory is not MISSING:
            default = field.default_factory()
        meta = _meta(annotation)
        text = str((meta.extra or {}).get("default", ""))
        help_text = meta.description or words.get(field.name, "")
        yield Key(path, annotation, default, help_text, text)


def entry_keys(key: Key) -> Iterator[Key]:
    """The keys of an entry of a list of sections, with paths after `[[key]]`."""
    item = _item_section(key.type)
    if item is not None:
        yield from keys_of(item, f"[[{key.path}]] ")


def build(section: Any, values: Mapping[str, Any], prefix: str = "") -> Any:
    """Builds a section from the values of its keys by path; absent keys have their defaults."""
    hints = get_type_hints(section, include_extras=True)
    chosen = {}
    for field in fields(section):
        path = prefix + field.name
        table = _table(hints[field.name])
        if table is not None:
            chosen[field.name] = table.built(values, prefix)
        elif is_dataclass(hints[field.name]):
            chosen[field.name] = build(hints[field.name], values, f"{path}.")
        elif path in values:
            chosen[field.name] = values[path]
    return section(**chosen)


def convert_value(annotation: Any, value: Any, path: str, where: Callable[[str], str]) -> Any:
    """Converts a value to the key's type. `where` returns the origin of a key, such as `file:line`.

    Raises ConfigError with origin, path, value and permitted values.
    """
    item = _item_section(annotation)
    if item is not None:
        return _convert_sections(item, value, path, where)
    try:
        check_numbers(value)
        return convert(value, annotation, dec_hook=_path)
    except MalformedError:
        raise ConfigError(
            f"{path} = {as_toml(value)[:_LONGEST_SHOWN]} does not do",
            where(path),
            f"give {path} {describe_type(annotation)}"
            + _list_example(annotation, value, path, where(path)),
        ) from None


def _convert_sections(
    item: Any, value: Any, path: str, where: Callable[[str], str]
) -> tuple[Any, ...]:
    if not isinstance(value, list) or not all(isinstance(entry, dict) for entry in value):
        raise ConfigError(
            f"{path} is not a list of sections", where(path), f"write it as [[{path}]]"
        )
    if len(value) > _MOST_SECTIONS:
        raise ConfigError(
            f"{path} has {len(value)} sections", where(path), f"give at most {_MOST_SECTIONS}"
        )
    keys = {key.path: key for key in keys_of(item)}
    required = [f.name for f in fields(item) if f.default is f.default_factory is MISSING]
    out = []
    for i, entry in enumerate(value):
        here, flat = f"{path}[{i}]", dict(leaves(entry))
        for name in flat:
            if name not in keys:
                raise unknown_key(f"{here}.{name}", name, keys, where(f"{here}.{name}"))
        for name in required:
            if name not in flat:
                raise ConfigError(
                    f"{here} has no {name!r}", where(here), f'add {name} = "..." to that section'
                )
        chosen = {
            name: convert_value(keys[name].type, raw, f"{here}.{name}", where)
            for name, raw in flat.items()
        }
        out.append(build(item, chosen))
    return tuple(out)


def leaves(data: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """(path, value) of every leaf; lists of tables are leaves."""
    for name, value in data.items():
        if isinstance(value, dict):
            yield from leaves(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def unknown_key(
    path: str, name: str, keys: Mapping[str, Any], where: str, prefix: str = ""
) -> ConfigError:
    """The error of an unknown key, with the most similar valid one. prefix: what all of them begin with, which makes none
    similar."""
    short = name.removeprefix(prefix)[:_LONGEST_SHOWN]
    known = [key.removeprefix(prefix) for key in keys]
    near = difflib.get_close_matches(short, known, n=1, cutoff=0.5)
    fix = f"did you mean {prefix + near[0]!r}?" if near else "`mocapd check-config` lists every key"
    return ConfigError(f"unknown key {path[:_LONGEST_SHOWN]!r}", where, fix)


def as_toml(value: Any) -> str:
    """A value roughly in TOML syntax, for messages; hides passwords of addresses."""
    if value is None or value is MISSING:
        return '""'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str | Path):
        return json.dumps(without_password(str(value)), ensure_ascii=False)  # escaped as in TOML
    if isinstance(value, list | tuple):
        return "[" + ", ".join(as_toml(v) for v in value) + "]"
    if is_dataclass(value):
        pairs = ((f.name, getattr(value, f.name), f.default) for f in fields(value))
        return "{" + ", ".join(f"{n} = {as_toml(v)}" for n, v, d in pairs if v != d) + "}"
    return brief(value) if isinstance(value, int | float) else str(value)


def describe_type(annotation: Any) -> str:
    """The permitted values in words: "a whole number from 1 to 65535"."""
    meta, bare = _meta(annotation), _bare(annotation)
    if get_origin(bare) is Literal:
        return "one of " + ", ".join(as_toml(choice) for choice in get_args(bare))
    if get_origin(bare) is tuple:
        args = get_args(bare)
        if args[-1] is Ellipsis:
            return f"a list, each of it {describe_type(args[0])}"
        return f"a list of {len(args)}, each of it {describe_type(args[0])}"
    words = {bool: "true or false", int: "a whole number", float: "a number", str: "text"}
    words[Path] = "the path of a file or folder"
    return words.get(bare, str(bare)) + _limits(meta)


def _list_example(annotation: Any, value: Any, path: str, where: str) -> str:
    """An example of a list's syntax; contains the given value if that is an item, or several with commas."""
    args = get_args(_bare(annotation))
    if get_origin(_bare(annotation)) is not tuple:
        return ""
    count = 2 if args[-1] is Ellipsis else len(args)
    example: Any = [{str: "one", float: 0.5, bool: True}.get(_bare(args[0]), 1)] * count
    is_huge = isinstance(value, int) and value.bit_length() > _LARGEST_BITS
    if isinstance(value, str | int | float) and not is_huge:
        parts = [part.strip() for part in str(value).strip("[]").split(",")]
        for items in (parts, [_whole_number(part) for part in parts]):
            with suppress(MalformedError):
                example = convert(items, annotation)
    written = as_toml(example)[:_LONGEST_SHOWN]
    # quoted for the shell
    return (
        f", such as --set '{path}={written}'" if where == COMMAND_LINE else f", such as {written}"
    )


def _whole_number(text: str) -> int | str:
    """The number, or the text if it is no plausible number."""
    return int(text) if text.isdecimal() and len(text) < _LARGEST_BITS // 4 else text


def _limits(meta: Meta) -> str:
    low = meta.ge if meta.ge is not None else meta.gt
    high = meta.le if meta.le is not None else meta.lt
    if low is not None and high is not None:
        return f" from {low} to {high}"
    if low is not None:
        return f", {low} or more" if meta.ge is not None else f" above {low}"
    if high is not None:
        return f", at most {high}"
    if meta.pattern is not None:
        return f" that matches {meta.pattern}"
    if meta.max_length is not None:
        return f" of at most {meta.max_length} characters"
    return ""


def _docstring_words(section: Any) -> dict[str, str]:
    """The lines `name: words` or `name, name: words` of the docstrings, with their continuations."""
    words: dict[str, str] = {}
    for kind in reversed(section.__mro__[:-1]):
        current: list[str] = []
        for line in inspect.cleandoc(kind.__doc__ or "").splitlines():
            head = re.fullmatch(r"([a-z]\w*(?:, [a-z]\w*)*): (.+)", line)
            if head:
                current = head[1].split(", ")
                words |= dict.fromkeys(current, head[2])
            elif line.startswith(" "):
                words |= {name: f"{words[name]} {line.strip()}" for name in current}
            else:
                current = []
    return words


def _item_section(annotation: Any) -> Any:
    """The section type of a list of sections, or None."""
    bare = _bare(annotation)
    args = get_args(bare)
    return args[0] if get_origin(bare) is tuple and args and is_dataclass(args[0]) else None


def _table(annotation: Any) -> SectionTable | None:
    extras = annotation.__metadata__ if get_origin(annotation) is Annotated else ()
    return next((extra for extra in extras if isinstance(extra, SectionTable)), None)


def _meta(annotation: Any) -> Meta:
    if get_origin(annotation) in (Union, types.UnionType):
        annotation = next(a for a in get_args(annotation) if a is not types.NoneType)
    if get_origin(annotation) is Annotated:
        for extra in annotation.__metadata__:
            if isinstance(extra, Meta):
                return extra
    return Meta()


def _bare(annotation: Any) -> Any:
    """The type without Annotated and without `| None`."""
    if get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    if get_origin(annotation) in (Union, types.UnionType):
        annotation = next(a for a in get_args(annotation) if a is not types.NoneType)
        return _bare(annotation)
    return annotation


def _path(kind: type, value: Any) -> Any:
    if kind is Path and isinstance(value, str):
        return Path(value)
    raise ValueError(kind)
