"""The effective configuration, with the origin of each value.

Precedence: flag > environment MOCAPD_* > config file > built-in. Parts receive only their own sections.
"""

import logging
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import platformdirs

from mocapd.boundary.files import is_absent, user_path
from mocapd.config.config_keys import (
    COMMAND_LINE,
    Key,
    as_toml,
    build,
    convert_value,
    keys_of,
    leaves,
    unknown_key,
)
from mocapd.config.removed_keys import REMOVED
from mocapd.config.sections import CameraSection, Config
from mocapd.config.sources import ENV_PREFIX, NOT_KEYS, TomlFile, env_name, parse_value, read_toml
from mocapd.errors import ConfigError
from mocapd.trackers.registry import RENAMED

_log = logging.getLogger(__name__)

BUILT_IN = "built-in"

Values = dict[str, tuple[Any, str]]  # key path: value, origin


@dataclass(frozen=True, slots=True)
class Setting:
    """One key with its effective value and origin."""

    key: Key
    value: Any
    origin: str

    @property
    def is_changed(self) -> bool:
        """True if the value is not the built-in one."""
        return self.origin != BUILT_IN


@dataclass(frozen=True, slots=True)
class Effective:
    """The effective configuration. `file`: the config file, None without one."""

    config: Config
    settings: tuple[Setting, ...]
    file: Path | None

    @property
    def chosen_instance(self) -> str:
        """The instance that the command line names; empty if it names none."""
        named = any(s.key.path == "instance" and s.origin == COMMAND_LINE for s in self.settings)
        return self.config.instance if named else ""


def all_keys() -> dict[str, Key]:
    """Every key by path, in the order of the documentation."""
    return {key.path: key for key in keys_of(Config)}


def config_candidates() -> tuple[Path, ...]:
    """Candidate paths of the config file; the first one present is read.

    An inaccessible one is an error: ignoring it would drop passwords and TLS.
    """
    return (
        platformdirs.user_config_path("mocapd") / "config.toml",
        Path("/etc/mocapd/config.toml"),
    )


def load_config(
    flags: Mapping[str, str] | None = None,
    file: Path | None = None,
    env: Mapping[str, str] | None = None,
    candidates: Sequence[Path] | None = None,
) -> Effective:
    """Reads all sources and checks all values.

    `flags`: key paths to text, from `--set`. `file`: the config file, which must exist. A tracker's former name becomes
    the present one, with a warning in the log. Raises ConfigError with origin, key, value and fix; InputError when the
    file cannot be read.
    """
    env = os.environ if env is None else env
    if file is None and env.get("MOCAPD_CONFIG"):
        file = user_path(env["MOCAPD_CONFIG"])
    if file is None:
        paths = config_candidates() if candidates is None else candidates
        file = next((path for path in paths if not is_absent(path)), None)
    keys = all_keys()
    given: Values = _from_file(read_toml(file), keys) if file else {}
    given |= _from_env(env, keys)
    given |= _from_flags(flags or {}, keys)
    _rename_tracker(given)
    values = {path: value for path, (value, _) in given.items()}
    settings = tuple(
        Setting(key, *given.get(path, (key.default, BUILT_IN))) for path, key in keys.items()
    )
    return Effective(_build_config(values, given), settings, file)


def _from_file(file: TomlFile, keys: Mapping[str, Key]) -> Values:
    values: Values = {}
    folder = file.path.parent.absolute()
    sections = {path.partition(".")[0]: path for path in keys}
    for name, value in file.data.items():
        if name not in sections:
            raise unknown_key(name, name, sections, file.where(name))
        if isinstance(value, dict) and name in keys:
            raise ConfigError(f"[{name}] is not a section", file.where(name), f"write [[{name}]]")
        if not isinstance(value, dict) and name not in keys:
            raise ConfigError(
                f"{name} = {as_toml(value)}, but it is a section",
                file.where(name),
                f"write [{name}] and its keys below",
            )
    for path, raw in leaves(file.data):
        if path not in keys:
            raise _unknown_key_error(path, keys, file.where(path))
        key, where = keys[path], file.where(path)
        value = convert_value(key.type, raw, path, file.where)
        values[path] = (_absolute(folder, key, value, where), where)
    return values


def _from_env(env: Mapping[str, str], keys: Mapping[str, Key]) -> Values:
    by_name = {env_name(path): key for path, key in keys.items()}
    removed = {env_name(path): path for path in REMOVED}
    values: Values = {}
    for name in sorted(env):
        if not name.startswith(ENV_PREFIX) or name in NOT_KEYS:
            continue
        if name in removed:
            raise _unknown_key_error(removed[name], keys, f"environment {name}")
        if name not in by_name:
            raise unknown_key(name, name, by_name, "environment", ENV_PREFIX)
        values[by_name[name].path] = _from_text(by_name[name], env[name], f"environment {name}")
    return values


def _from_flags(flags: Mapping[str, str], keys: Mapping[str, Key]) -> Values:
    values: Values = {}
    for path, text in flags.items():
        if path not in keys:
            raise _unknown_key_error(path, keys, COMMAND_LINE)
        values[path] = _from_text(keys[path], text, COMMAND_LINE)
    return values


def _rename_tracker(values: Values) -> None:
    """Replaces a tracker's former name by the present one."""
    name, origin = values.get("tracker.name", ("", ""))
    if name in RENAMED:
        values["tracker.name"] = (RENAMED[name], origin)
        _log.warning(
            "%s: tracker.name: %r is now named %r; the next release no longer accepts the old name",
            origin,
            name,
            RENAMED[name],
        )


def _unknown_key_error(path: str, keys: Mapping[str, Key], where: str) -> ConfigError:
    if path in REMOVED:
        return ConfigError(f"there is no key {path!r} any more", where, REMOVED[path])
    return unknown_key(path, path, keys, where)


def _from_text(key: Key, text: str, origin: str) -> tuple[Any, str]:
    try:
        text.encode()
    except UnicodeEncodeError:  # invalid bytes, which no output could show
        raise ConfigError(f"{key.path} is no UTF-8 text", origin, "give it another name") from None
    parsed = parse_value(text, key.wants_text)
    value = convert_value(key.type, parsed, key.path, lambda _: origin)
    return _absolute(Path.cwd(), key, value, origin), origin


def _absolute(folder: Path, key: Key, value: Any, where: str) -> Any:
    """Makes paths absolute; relative paths start at the folder of the config file."""
    try:
        if isinstance(value, Path):
            return folder / user_path(value)
        if key.is_path and value:
            return str(folder / user_path(value))
        if key.path == "camera":
            return tuple(_absolute_camera(folder, camera) for camera in value)
    except ConfigError as error:
        raise ConfigError(f"{key.path} = {error.what}", where, error.fix) from None
    return value


def _absolute_camera(folder: Path, camera: CameraSection) -> CameraSection:
    from mocapd.capture.kinds.source_kinds import address_in_folder  # imports every kind of source

    strokes = camera.white_balance
    return replace(
        camera,
        source=address_in_folder(folder, camera.source),
        white_balance=folder / user_path(strokes) if strokes else None,
    )


def _build_config(values: Mapping[str, Any], given: Values) -> Config:
    try:
        config: Config = build(Config, values)
    except ConfigError as error:
        # the part's error has key and fix; add the value's origin
        origin = given[error.where][1] if error.where in given else ""
        where = f"{origin}: {error.where}" if origin else error.where
        raise ConfigError(error.what, where, error.fix) from None
    ids = [camera.id for camera in config.camera]
    for name in ids:
        if ids.count(name) > 1:
            raise ConfigError(
                f"two cameras have the id {name!r}", given["camera"][1], "rename one of them"
            )
    return config
