"""Renders the files of `systemd/` for installation, with the command that starts this mocapd."""

from pathlib import Path

from mocapd.assets import systemd_path
from mocapd.errors import ConfigError

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
            "no unit can name this path", ascii(path), "install mocapd under a plainer path"
        )
    path = path.replace("%", "%%")
    quoted = f'"{path}"' if " " in path else path
    return f"{quoted} -P -m mocapd.cli.main"
