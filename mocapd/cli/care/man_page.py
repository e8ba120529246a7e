"""The manual page mocapd(1) in roff, from the parser of the command line itself."""

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import typer
import typer.core

import mocapd

if TYPE_CHECKING:
    from typer._click import Command  # part of typer

_EXIT_CODES = (
    ("0", "done; also after SIGTERM, or when its terminal is closed"),
    ("1", "nobody listens (send-test), something is bad (doctor), or the reader of a pipe has ended"),
    ("2", "the command line is wrong"),
    ("3, 4, 150, 151", "of status alone: none is running, one does not answer, cannot track, or is too slow"),
    ("66", "an input is missing or damaged"),
    ("69", "something is unavailable: a port, a camera, a daemon"),
    ("70", "a bug"),
    ("73", "a file or the output cannot be written"),
    ("77", "a right is missing"),
    ("78", "the configuration or a calibration is wrong"),
    ("130", "Ctrl-C"),
)  # fmt: skip
_FILES = (
    ("$XDG_CONFIG_HOME/mocapd/config.toml, /etc/mocapd/config.toml", "the configuration; the first that is there"),
    ("$XDG_STATE_HOME/mocapd, $STATE_DIRECTORY", "calibration.toml with its pictures, a setup in progress, keys"),
    ("$XDG_CACHE_HOME/mocapd, $CACHE_DIRECTORY", "what can be made again"),
    ("$XDG_RUNTIME_DIR/mocapd, $RUNTIME_DIRECTORY", "the control socket of each running daemon, and where its page is"),
)  # fmt: skip
_ENVIRONMENT = (
    ("MOCAPD_CONFIG", "the config file to read"),
    ("MOCAPD_KEY, MOCAPD_SECTION_KEY", "one key each; mocapd check-config prints what is in force"),
    ("NO_COLOR", "no colours"),
)
# The backslash first: the other escapes contain one.
_ESCAPES = (
    ("\\", r"\e"), ("-", r"\-"), ('"', r"\(dq"), ("'", r"\(aq"), ("`", r"\(ga"), ("^", r"\(ha"), ("~", r"\(ti"),
)  # fmt: skip
_NOT_ASCII = re.compile(r"[^\x20-\x7e]")


def man_page(group: "Command") -> str:
    """The whole page; deterministic for a version."""
    assert isinstance(group, typer.core.TyperGroup)
    top = typer.Context(group, info_name="mocapd")
    lines = [
        f'.TH MOCAPD 1 "" "mocapd {mocapd.__version__}" "User Commands"',
        ".SH NAME",
        rf"mocapd \- {_text('webcams in, a body pose out')}",
        ".SH SYNOPSIS",
        r".B mocapd",
        r"\fICOMMAND\fR [\fIOPTIONS\fR]",
        ".SH DESCRIPTION",
        _text(group.help or ""),
        ".SH COMMANDS",
    ]
    for name in group.list_commands(top):
        command = group.get_command(top, name)
        if command is not None and not command.hidden:
            lines += _command(command, typer.Context(command, info_name=name, parent=top))
    lines += [*_table("EXIT STATUS", _EXIT_CODES), *_table("FILES", _FILES)]
    lines += _table("ENVIRONMENT", _ENVIRONMENT)
    return "\n".join(lines) + "\n"


def _command(command: "Command", context: typer.Context) -> Iterator[str]:
    """A command's section: usage, help, arguments and options, example."""
    usage = " ".join(command.collect_usage_pieces(context))
    yield f'.SS "{_text(f"mocapd {context.info_name} {usage}")}"'
    example = ""
    for number, paragraph in enumerate((command.help or "").split("\n\n")):
        text = " ".join(paragraph.split())
        if text.startswith("Example: "):
            example = text.removeprefix("Example: ")
            continue
        yield from ([".PP"] if number else [])
        yield _text(text)
    for parameter in command.params:
        record = parameter.get_help_record(context)
        if record is not None:
            yield from (".TP", rf"\fB{_text(record[0])}\fR", _text(record[1]))
    if example:
        yield from (".PP", "Example:", ".PP", ".nf", ".RS", _text(example), ".RE", ".fi")


def _table(title: str, rows: Sequence[tuple[str, str]]) -> Iterator[str]:
    yield f".SH {title}"
    for term, meaning in rows:
        yield from (".TP", rf"\fB{_text(term)}\fR", _text(meaning))


def _text(text: str) -> str:
    """Escaped for roff: nothing in it is a command, and a hyphen can be copied as one."""
    text = " ".join(text.split())
    for mark, escape in _ESCAPES:
        text = text.replace(mark, escape)
    text = _NOT_ASCII.sub(lambda match: rf"\[u{ord(match[0]):04X}]", text)
    return rf"\&{text}" if text.startswith(".") else text
