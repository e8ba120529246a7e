"""The configuration in force, and where each of its values came from.

Precedence: flag > environment MOCAPD_* > config file > built-in. No part ever sees the whole of it;
`service.py` hands each its own section.
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
    build,
    converted,
    keys_of,
    leaves,
    shown,
    unknown_key,
)
from mocapd.config.removed_keys import REMOVED
from mocapd.config.sections import CameraSection, Config
from mocapd.config.sources import ENV_PREFIX, NOT_KEYS, TomlFile, env_name, parsed, read_toml
from mocapd.errors import ConfigError
from mocapd.trackers.registry import RENAMED

_log = logging.getLogger(__name__)

BUILT_IN = "built-in"

Found = dict[str, tuple[Any, str]]  # key path: value, origin


@dataclass(frozen=True, slots=True)
class Setting:
    """One key with its effective value and where that came from."""

    key: Key
    value: Any
    origin: str

    @property
    def changed(self) -> bool:
        """Whether anything but the program itself set it."""
        return self.origin != BUILT_IN


@dataclass(frozen=True, slots=True)
class Effective:
    """The configuration in force. `file`: the config file that was read, None when there is none."""

    config: Config
    settings: tuple[Setting, ...]
    file: Path | None


def known_keys() -> dict[str, Key]:
    """Every key by its path, in the order in which they are documented."""
    return {key.path: key for key in keys_of(Config)}


def config_candidates() -> tuple[Path, ...]:
    """Where a config file is looked for, in this order; the first that is not absent is read.

    One that cannot be looked at is an error: as if there were none would drop passwords and TLS.
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
    """Read every source and check every value.

    `flags`: key paths to their text, as `--set` gives them. `file`: the config file, which must
    exist. A tracker's former name becomes the present one, with a warning in the log. Raises ConfigError
    naming the place, the key, the value and the mend; InputError when the file cannot be read.
    """
    env = os.environ if env is None else env
    if file is None and env.get("MOCAPD_CONFIG"):
        file = user_path(env["MOCAPD_CONFIG"])
    if file is None:
        given = config_candidates() if candidates is None else candidates
        file = next((path for path in given if not is_absent(path)), None)
    known = known_keys()
    found: Found = _from_file(read_toml(file), known) if file else {}
    found |= _from_env(env, known)
    found |= _from_flags(flags or {}, known)
    _rename_tracker(found)
    values = {path: value for path, (value, _) in found.items()}
    settings = tuple(
        Setting(key, *found.get(path, (key.default, BUILT_IN))) for path, key in known.items()
    )
    return Effective(_built(values, found), settings, file)


def _from_file(file: TomlFile, known: Mapping[str, Key]) -> Found:
    found: Found = {}
    folder = file.path.parent.absolute()
    sections = {path.partition(".")[0]: path for path in known}
    for name, value in file.data.items():
        if name not in sections:
            raise unknown_key(name, name, sections, file.where(name))
        if isinstance(value, dict) and name in known:
            raise ConfigError(f"[{name}] is not a section", file.where(name), f"write [[{name}]]")
        if not isinstance(value, dict) and name not in known:
            raise ConfigError(
                f"{name} = {shown(value)}, but it is a section",
                file.where(name),
                f"write [{name}] and its keys below",
            )
    for path, raw in leaves(file.data):
        if path not in known:
            raise _unknown(path, known, file.where(path))
        value = converted(known[path].type, raw, path, file.where)
        found[path] = (_beside(folder, known[path], value, file.where(path)), file.where(path))
    return found


def _from_env(env: Mapping[str, str], known: Mapping[str, Key]) -> Found:
    by_name = {env_name(path): key for path, key in known.items()}
    removed = {env_name(path): path for path in REMOVED}
    found: Found = {}
    for name in sorted(env):
        if not name.startswith(ENV_PREFIX) or name in NOT_KEYS:
            continue
        if name in removed:
            raise _unknown(removed[name], known, f"environment {name}")
        if name not in by_name:
            raise unknown_key(name, name, by_name, "environment")
        found[by_name[name].path] = _from_text(by_name[name], env[name], f"environment {name}")
    return found


def _from_flags(flags: Mapping[str, str], known: Mapping[str, Key]) -> Found:
    found: Found = {}
    for path, text in flags.items():
        if path not in known:
            raise _unknown(path, known, COMMAND_LINE)
        found[path] = _from_text(known[path], text, COMMAND_LINE)
    return found


def _rename_tracker(found: Found) -> None:
    """Replace a former name of a tracker by the present one."""
    name, origin = found.get("tracker.name", ("", ""))
    if name in RENAMED:
        found["tracker.name"] = (RENAMED[name], origin)
        _log.warning(
            "%s: tracker.name: %r is now named %r; the next release no longer accepts the old name",
            origin,
            name,
            RENAMED[name],
        )


def _unknown(path: str, known: Mapping[str, Key], where: str) -> ConfigError:
    if path in REMOVED:
        return ConfigError(f"there is no key {path!r} any more", where, REMOVED[path])
    return unknown_key(path, path, known, where)


def _from_text(key: Key, text: str, origin: str) -> tuple[Any, str]:
    try:
        text.encode()
    except UnicodeEncodeError:  # bytes of a command line or a variable; no output could say it
        raise ConfigError(f"{key.path} is no UTF-8 text", origin, "give it another name") from None
    value = converted(key.type, parsed(text, key.wants_text), key.path, lambda _: origin)
    return _beside(Path.cwd(), key, value, origin), origin


def _beside(folder: Path, key: Key, value: Any, where: str) -> Any:
    """Paths made absolute: a relative one is meant from the file that holds it."""
    try:
        if isinstance(value, Path):
            return folder / user_path(value)
        if key.is_path and value:
            return str(folder / user_path(value))
        if key.path == "camera":
            return tuple(_camera_beside(folder, camera) for camera in value)
    except ConfigError as error:
        raise ConfigError(f"{key.path} = {error.what}", where, error.fix) from None
    return value


def _camera_beside(folder: Path, camera: CameraSection) -> CameraSection:
    from mocapd.capture.kinds.source_kinds import address_in_folder  # imports every kind of source

    strokes = camera.white_balance
    return replace(
        camera,
        source=address_in_folder(folder, camera.source),
        white_balance=folder / user_path(strokes) if strokes else None,
    )


def _built(values: Mapping[str, Any], found: Found) -> Config:
    try:
        config: Config = build(Config, values)
    except ConfigError as error:
        # the part knows key and mend, we know where the value was given
        origin = found[error.where][1] if error.where in found else ""
        where = f"{origin}: {error.where}" if origin else error.where
        raise ConfigError(error.what, where, error.fix) from None
    ids = [camera.id for camera in config.camera]
    for name in ids:
        if ids.count(name) > 1:
            raise ConfigError(
                f"two cameras have the id {name!r}", found["camera"][1], "rename one of them"
            )
    return config
