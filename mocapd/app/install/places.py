"""Target folders of the service's files: for this machine, for one user, or for a package build."""

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from mocapd.app.install.own_file import with_marker
from mocapd.assets import systemd_path
from mocapd.errors import ConfigError

UNIT = "mocapd.service"


UNITS = (
    "mocapd.service",
    "mocapd@.service",
    "mocapd-camera-node.service",
    "mocapd-prepare.service",
)
USER_UNIT = "mocapd-user.service"
EXAMPLE = "network.conf"
SYSUSERS = "mocapd.sysusers"
CONFIG = "config.toml"

_COMMAND, _SANDBOX = "@COMMAND@", "@SANDBOX@\n"
_SPECIAL = "\"'\\$"  # to systemd, in a command line


def text_of(name: str) -> str:
    """The unrendered text of a file."""
    return systemd_path(name).read_text("utf-8")


def unit_text(name: str, python: Path) -> str:
    """A unit that starts mocapd with this interpreter. Raises ConfigError for a path that no unit can name."""
    text = text_of(name).replace(_SANDBOX, text_of("sandbox.conf"))
    return text.replace(_COMMAND, command(python))


def command(python: Path) -> str:
    """The beginning of ExecStart=, up to the subcommand.

    -P: no imports from the working directory.
    """
    path = str(python)
    if not path.startswith("/") or any(c in _SPECIAL or not c.isprintable() for c in path):
        raise ConfigError(
            "no unit can name this path",
            ascii(path),
            "give the whole path, from / on, or install mocapd under a plainer path",
        )
    path = path.replace("%", "%%")
    quoted = f'"{path}"' if " " in path else path
    return f"{quoted} -P -m mocapd.cli.main"


@dataclass(frozen=True, slots=True)
class PlacedFile:
    """One file; `is_admins`: written once, then the admin's."""

    path: Path
    text: str
    is_admins: bool = False


@dataclass(frozen=True, slots=True)
class InstallPaths:
    """Folders; None for files that are not installed. `units`, `user_units`: of systemd, `examples`: drop-ins that
    nothing reads, `config`: of mocapd."""

    units: Path | None
    user_units: Path | None
    examples: Path | None = None
    sysusers: Path | None = None
    config: Path | None = None


def of_machine() -> InstallPaths:
    """The folders for an admin's own units."""
    units = Path("/etc/systemd/system")
    return InstallPaths(
        units=units,
        user_units=None,
        examples=units / f"{UNIT}.d",
        sysusers=Path("/etc/sysusers.d"),
        config=Path("/etc/mocapd"),
    )


def of_user() -> InstallPaths:
    """The folders of the current user. Without a configuration, which would hide the machine's."""
    given = os.environ.get("XDG_CONFIG_HOME", "")
    base = Path(given) if given.startswith("/") else Path.home() / ".config"
    return InstallPaths(units=None, user_units=base / "systemd/user")


def of_package(root: Path) -> InstallPaths:
    """The folders of packages, below `root`."""
    lib = root / "usr/lib"
    return InstallPaths(
        units=lib / "systemd/system",
        user_units=lib / "systemd/user",
        examples=root / "usr/share/doc/mocapd/examples",
        sysusers=lib / "sysusers.d",
        config=root / "etc/mocapd",
    )


def files(places: InstallPaths, python: Path) -> Iterator[PlacedFile]:
    """Every file with its text; the units start mocapd with this interpreter. Raises ConfigError."""
    drop_in = "`systemctl edit {}`"
    if places.units is not None:
        for name in UNITS:
            text = with_marker(
                unit_text(name, python), drop_in.format(name.removesuffix(".service"))
            )
            yield PlacedFile(places.units / name, text)
    if places.user_units is not None:
        text = with_marker(unit_text(USER_UNIT, python), drop_in.format("--user mocapd"))
        yield PlacedFile(places.user_units / UNIT, text)
    if places.examples is not None:
        text = with_marker(text_of(EXAMPLE), "a copy")
        yield PlacedFile(places.examples / f"{EXAMPLE}.example", text)
    if places.sysusers is not None:
        text = with_marker(text_of(SYSUSERS), "a file of your own in the same folder")
        yield PlacedFile(places.sysusers / "mocapd.conf", text)
    if places.config is not None:
        yield PlacedFile(places.config / CONFIG, text_of(CONFIG), is_admins=True)
