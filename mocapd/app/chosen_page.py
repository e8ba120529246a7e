"""Which of this user's running processes a command is meant for."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from mocapd.errors import ConfigError, UnavailableError
from mocapd.outputs.instance import chunk

if TYPE_CHECKING:
    from mocapd.config.sections import Config
    from mocapd.web.runtime_file import Running


def pages_meant(pages: "Sequence[Running]", config: "Config") -> "Sequence[Running]":
    """Of several those of this configuration: by its instance, then by its state directory."""
    if len(pages) > 1 and config.instance:
        named = [page for page in pages if page.instance == chunk(config.instance)]
        pages = named or pages
    if len(pages) > 1:
        own = str(config.state_dir.resolve())
        beside = [page for page in pages if page.state_dir == own]
        pages = beside or pages
    return pages


def daemon_meant(config: "Config") -> "Running":
    """The one daemon of this user that a command is meant for. Raises UnavailableError or ConfigError."""
    from mocapd.web.runtime_file import running, runtime_folder

    # a setup by itself has no name
    daemons = [page for page in running(runtime_folder(config.state_dir)) if page.instance]
    meant = pages_meant(daemons, config)
    if not meant:
        raise UnavailableError(
            "no mocapd of yours is running that could be told",
            "this machine",
            "start `mocapd run`, with web.enabled = true: it is told through its page's port",
        )
    if len(meant) > 1:
        names = ", ".join(f"{one.instance} (pid {one.pid})" for one in meant)
        raise ConfigError(
            f"several are running: {names}", "command line", "choose by --set instance=NAME"
        )
    return meant[0]
