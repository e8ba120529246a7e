"""Which of this user's running pages a command is meant for."""

from typing import TYPE_CHECKING

from mocapd.errors import ConfigError, UnavailableError

if TYPE_CHECKING:
    from mocapd.config.sections import Config
    from mocapd.web.runtime_file import Running


def page_meant(config: "Config") -> "Running":
    """The one daemon of this user with a page that a command is meant for. Raises UnavailableError or ConfigError."""
    from mocapd.config.runtime_folder import runtime_folder
    from mocapd.control.meant import meant
    from mocapd.web.runtime_file import running

    # a setup by itself has no name
    pages = [page for page in running(runtime_folder(config.state_dir)) if page.instance]
    chosen = meant(pages, config)
    if not chosen:
        raise UnavailableError(
            "no mocapd of yours is running that has a page",
            "this machine",
            "start `mocapd run`, with web.enabled = true",
        )
    if len(chosen) > 1:
        names = ", ".join(f"{one.instance} (pid {one.pid})" for one in chosen)
        raise ConfigError(
            f"several are running: {names}", "command line", "choose by --set instance=NAME"
        )
    return chosen[0]
