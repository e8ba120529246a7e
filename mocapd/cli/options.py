"""Common options of the commands, and their effect on the configuration."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.errors import MocapdError, UsageError

if TYPE_CHECKING:
    from mocapd.config.effective import Effective


def complete_setting(incomplete: str) -> list[str]:
    """Completions of --set: keys, and the values of a switch."""
    from mocapd.config.effective import all_keys

    key, has_value, _ = incomplete.partition("=")
    if not has_value:
        return [f"{name}=" for name in all_keys() if name.startswith(key)]
    return [f"{key}={value}" for value in ("true", "false") if _is_switch(key)]


def _is_switch(key: str) -> bool:
    from mocapd.config.effective import all_keys

    entry = all_keys().get(key)
    return entry is not None and isinstance(entry.default, bool)


ConfigOption = Annotated[
    Path | None,
    typer.Option("--config", help="Config file to read instead of the usual one.", metavar="FILE"),
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Set one config key, e.g. --set zenoh.port=7448.",
        metavar="KEY=VALUE",
        autocompletion=complete_setting,
    ),
]
CameraOption = Annotated[
    list[str] | None,
    typer.Option(
        "--camera",
        help="A camera, instead of those of the config; repeat it. See `mocapd cameras`.",
        metavar="ID=SOURCE",
    ),
]
CaptureOption = Annotated[
    str | None,
    typer.Option(help="All cameras of a capture folder, or of sim:SCENARIO.", metavar="FOLDER"),
]
ForceOption = Annotated[
    bool,
    typer.Option("--force", help="Replace a file that is there."),
]

VrmOption = Annotated[
    Path | None,
    typer.Option(
        "--vrm",
        help="Send VMC with the bones of this avatar: vmc.vrm, with vmc.enabled.",
        metavar="FILE",
    ),
]


def vrm_flags(vrm: Path | None) -> dict[str, str]:
    """The flags of --vrm for `effective_config`."""
    return {} if vrm is None else {"vmc__vrm": str(vrm), "vmc__enabled": "true"}


def effective_config(
    config: Path | None,
    settings: list[str] | None,
    cameras: list[str] | None = None,
    capture: str | None = None,
    **flags: str | None,
) -> "Effective":
    """The configuration with these flags on top; `flags` are keys with `__` for the dot.

    `capture`: a folder or scenario; all of its cameras are used.
    """
    from mocapd.config.effective import load_config

    given = _settings_by_key(settings)
    if capture is not None:
        from mocapd.session.session import cameras_of

        used = [(camera.id, camera.source) for camera in cameras_of(capture)]
        given["camera"] = _camera_list(used)
    if cameras:
        given["camera"] = _camera_list([_camera(text) for text in cameras])
    given |= {key.replace("__", "."): value for key, value in flags.items() if value is not None}
    return load_config(given, config)


def config_to_look_after(
    config: Path | None, settings: list[str] | None
) -> "tuple[Effective, MocapdError | None]":
    """The configuration, for commands that control a running daemon or need only the log level, even if the config file
    has become invalid: then the defaults with these flags, and the error. Raises ConfigError or UsageError for flags."""
    from mocapd.config.effective import load_config

    try:
        return effective_config(config, settings), None
    except MocapdError as error:
        return load_config(_settings_by_key(settings), env={}, candidates=()), error


def _settings_by_key(settings: list[str] | None) -> dict[str, str]:
    """The flags --set by their keys. Raises UsageError."""
    given: dict[str, str] = {}
    for text in settings or ():
        key, equals, value = text.partition("=")
        if not equals:
            raise UsageError(f"--set {_brief(text)}", "command line", "write --set KEY=VALUE")
        given[key.strip()] = value.strip()
    return given


def _camera(text: str) -> tuple[str, str]:
    name, equals, source = text.partition("=")
    if not equals or not name or not source:
        raise UsageError(f"--camera {_brief(text)}", "command line", "write --camera ID=SOURCE")
    return name, source


def _camera_list(cameras: list[tuple[str, str]]) -> str:
    """As TOML, the format of a flag's value."""
    entries = (
        f"{{id = {toml_string(name)}, source = {toml_string(source)}}}" for name, source in cameras
    )
    return f"[{', '.join(entries)}]"


def toml_string(text: str) -> str:
    """The text in quotes, escaped."""
    import tomli_w

    return tomli_w.dumps({"v": text}).removeprefix("v = ").strip()


def _brief(text: str) -> str:
    from mocapd.boundary.urls import without_password

    return without_password(text)[:200]
