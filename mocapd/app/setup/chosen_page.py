"""Selects the running page that a command addresses."""

from typing import TYPE_CHECKING

from mocapd.errors import ConfigError, UnavailableError

if TYPE_CHECKING:
    from mocapd.config.sections import Config
    from mocapd.web.runtime_file import Running


def target_page(config: "Config") -> "Running":
    """The addressed daemon with a page, of this user. Raises UnavailableError or ConfigError."""
    from mocapd.config.runtime_folder import runtime_folder
    from mocapd.control.target_process import select_targets
    from mocapd.web.runtime_file import running

    # a setup without a daemon has no name
    pages = [page for page in running(runtime_folder(config.state_dir)) if page.instance]
    chosen = select_targets(pages, config)
    if not chosen:
        raise UnavailableError(
            "no mocapd of yours is running that has a page",
            "this machine",
            "start `mocapd run`, with web.enabled = true",
        )
    if len(chosen) > 1:
        names = ", ".join(f"{page.instance} (pid {page.pid})" for page in chosen)
        raise ConfigError(
            f"several are running: {names}", "command line", "choose by --set instance=NAME"
        )
    return chosen[0]
