"""`mocapd check-config`"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapd.cli.options import CameraOption, ConfigOption, SetOption, effective_config

if TYPE_CHECKING:
    from mocapd.config import Setting
    from mocapd.config_keys import Key


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("check-config")(check_config)


def check_config(
    config: ConfigOption = None,
    settings: SetOption = None,
    cameras: CameraOption = None,
    changed: Annotated[bool, typer.Option("--changed", help="Only what is not built in.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
    as_markdown: Annotated[
        bool, typer.Option("--markdown", help="The table of all keys for the README.")
    ] = False,
) -> None:
    """Print each setting and where it came from.

    Ends with 78 and one line when something is wrong.

    Example: mocapd check-config --changed
    """
    if as_markdown:
        _print_markdown()
        return
    effective = effective_config(config, settings, cameras)
    rows = [s for s in effective.settings if s.changed or not changed]
    if as_json:
        print(json.dumps({s.key.path: {"value": _plain(s.value), "from": s.origin} for s in rows}))
        return
    _print_table(rows)


def _print_table(rows: "list[Setting]") -> None:
    from mocapd.config_keys import shown

    cells = [(s.key.path, shown(s.value), s.origin) for s in rows]
    widths = [max((len(row[i]) for row in cells), default=0) for i in range(2)]
    for key, value, origin in cells:
        print(f"{key:<{widths[0]}} = {value:<{widths[1]}}  # {origin}")


def _print_markdown() -> None:
    from mocapd.config import known_keys
    from mocapd.config_keys import entry_keys
    from mocapd.config_sources import env_name

    print("| key | default | environment | meaning |\n|---|---|---|---|")
    for path, key in known_keys().items():
        print(f"| `{path}` | {_default(key)} | `{env_name(path)}` | {key.help} |")
        for one in entry_keys(key):
            print(f"| `{one.path}` | {_default(one)} | | {one.help} |")


def _default(key: "Key") -> str:
    from dataclasses import MISSING

    from mocapd.config_keys import shown

    if key.default is MISSING:
        return "must be given"
    if key.default is None:
        return "none"
    return key.default_text or f"`{shown(key.default)}`"


def _plain(value: Any) -> Any:
    """A value as JSON has it."""
    from dataclasses import asdict, is_dataclass

    if isinstance(value, Path):
        return str(value)
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {name: _plain(item) for name, item in asdict(value).items()}
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    return value
