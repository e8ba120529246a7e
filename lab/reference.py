"""Write docs/commands.md and docs/configuration.md from the command line's parser and the configuration's sections.

python -m lab.reference docs
"""

import sys
from collections.abc import Iterator
from dataclasses import MISSING
from pathlib import Path
from typing import TYPE_CHECKING

import typer
import typer.main

from mocapd.cli.command_list import app
from mocapd.config.config_keys import Key, as_toml, entry_keys
from mocapd.config.effective import all_keys
from mocapd.config.sources import env_name

if TYPE_CHECKING:
    from typer._click import Command  # which typer brings itself

_COMMANDS = """\
# Commands

Written by `python -m lab.reference docs`; do not edit by hand.

Data goes to stdout, logs go to stderr. A command replaces an existing file only with `--force`. Exit codes are
in the manual page (`mocapd man`).
"""
_CONFIGURATION = """\
# Configuration

Written by `python -m lab.reference docs`; do not edit by hand.

A flag (`--set KEY=VALUE`) goes before an environment variable. A variable goes before the config file, which is
`$XDG_CONFIG_HOME/mocapd/config.toml`, else `/etc/mocapd/config.toml`. The file goes before the built-in value. A key that
does not exist is an error that names the nearest key, or what replaced it. `mocapd check-config` prints the values in force
and where each is from.

```toml
# relative paths start at this file's folder
[[camera]]
id = "left"                        # its name in the rig file
source = "usb:1-3:046d:0825:5F2A11B0"

[tracker]
stature_m = 1.75
```

"""


def commands_page() -> str:
    """docs/commands.md: usage, purpose, options and an example of every command."""
    group = typer.main.get_command(app)
    assert isinstance(group, typer.core.TyperGroup)
    top = typer.Context(group, info_name="mocapd")
    parts = [_COMMANDS]
    for name in group.list_commands(top):
        command = group.get_command(top, name)
        if command is not None and not command.hidden:
            context = typer.Context(command, info_name=name, parent=top)
            parts.append("\n".join(_command(name, command, context)))
    return "\n".join(parts) + "\n"


def _command(name: str, command: "Command", context: typer.Context) -> Iterator[str]:
    usage = " ".join(command.collect_usage_pieces(context))
    yield f"## mocapd {name}\n"
    yield f"    mocapd {name} {usage}".rstrip() + "\n"
    for paragraph in (command.help or "").split("\n\n"):
        text = " ".join(paragraph.split())
        if text.startswith("Example: "):
            text = f"Example: `{text.removeprefix('Example: ')}`"
        yield f"{text}\n"
    rows = [_option(parameter.get_help_record(context)) for parameter in command.params]
    if any(rows):
        yield "| option | meaning |\n|---|---|"
        yield from (row for row in rows if row)
        yield ""


def _option(record: tuple[str, str] | None) -> str:
    """A row of the table; empty for a hidden option."""
    if record is None:
        return ""
    name, meaning = (" ".join(text.split()).replace("|", r"\|") for text in record)
    return f"| `{name}` | {meaning} |"


def configuration_page() -> str:
    """docs/configuration.md: every key with its default, its variable and its meaning."""
    lines = ["| key | default | environment | meaning |", "|---|---|---|---|"]
    for path, key in all_keys().items():
        lines.append(f"| `{path}` | {_default(key)} | `{env_name(path)}` | {key.help} |")
        lines += [f"| `{one.path}` | {_default(one)} | | {one.help} |" for one in entry_keys(key)]
    return _CONFIGURATION + "\n".join(lines) + "\n"


def _default(key: Key) -> str:
    if key.default is MISSING:
        return "must be given"
    if key.default is None:
        return "none"
    return key.default_text or f"`{as_toml(key.default)}`"


def main(folder: Path) -> None:
    """Write both pages."""
    (folder / "commands.md").write_text(commands_page(), encoding="utf-8")
    (folder / "configuration.md").write_text(configuration_page(), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
