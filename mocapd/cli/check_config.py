"""`mocapd check-config`"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mocapd.app.daemon.unsafe_settings import unsafe_settings
from mocapd.cli.options import CameraOption, ConfigOption, SetOption, effective_config

if TYPE_CHECKING:
    from mocapd.config.effective import Setting
    from mocapd.config.sections import Config


def check_config(
    config: ConfigOption = None,
    settings: SetOption = None,
    cameras: CameraOption = None,
    changed: Annotated[
        bool, typer.Option("--changed", help="Only settings that differ from their defaults.")
    ] = False,
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object.")] = False,
) -> None:
    """Print each setting with its origin, the calibration that `mocapd run` would use, and unsafe settings.
    Passwords of cameras are not shown.

    Exit code 78 and one line if the configuration is invalid.

    Example: mocapd check-config --changed
    """
    effective = effective_config(config, settings, cameras)
    rows = [s for s in effective.settings if s.is_changed or not changed]
    if as_json:
        print(json.dumps({s.key.path: {"value": _plain(s.value), "from": s.origin} for s in rows}))
        return
    _print_table(rows)
    if not changed:
        _print_calibration(effective.config)
    from mocapd.outputs.output_table import unsafe_outputs

    # the daemon itself logs the warnings of outputs when it opens them
    for line in (*unsafe_settings(effective), *unsafe_outputs(effective.config.outputs)):
        print(f"# unsafe: {line}")


def _print_calibration(config: "Config") -> None:
    """Print a summary of the calibration as comments below the settings."""
    from mocapd.boundary.urls import without_password
    from mocapd.calibration.calibration_file import find_calibration

    saved = find_calibration(config.rig, config.state_dir, config.sources)
    if saved is None:
        used = (
            f"the rig {config.rig}" if config.rig else "none saved (`mocapd calibrate` makes one)"
        )
        print(f"# calibration: {used}")
        return
    tables, room = saved.tables, saved.tables.room
    assert room is not None  # reading refuses a calibration without extrinsics
    details = [f"made {tables.made.when:%Y-%m-%d %H:%M} UTC by {tables.made.by}"]
    details += [f"{room.rms_px:.2f} px"] if room.rms_px is not None else []
    details += [f"{room.play_area_cm:.1f} cm"] if room.play_area_cm is not None else []
    print(f"# calibration: {saved.path} ({', '.join(details)})")
    for camera in tables.camera:
        width, height = camera.size_px
        source = without_password(camera.source)
        print(f"#   {camera.id}: {source}, {width}x{height} at {camera.fps_hz:g} Hz")


def _print_table(rows: "list[Setting]") -> None:
    from mocapd.config.config_keys import as_toml

    cells = [(s.key.path, as_toml(s.value), s.origin) for s in rows]
    widths = [max((len(row[i]) for row in cells), default=0) for i in range(2)]
    for key, value, origin in cells:
        print(f"{key:<{widths[0]}} = {value:<{widths[1]}}  # {origin}")


def _plain(value: Any) -> Any:
    """A value as JSON, without passwords."""
    from dataclasses import asdict, is_dataclass

    from mocapd.boundary.urls import without_password

    if isinstance(value, str | Path):
        return without_password(str(value))
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    if is_dataclass(value) and not isinstance(value, type):
        return {name: _plain(item) for name, item in asdict(value).items()}
    if isinstance(value, dict):
        return {name: _plain(item) for name, item in value.items()}
    return value
