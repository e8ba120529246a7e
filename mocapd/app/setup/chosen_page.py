"""Selects the running page that a command addresses."""

from typing import TYPE_CHECKING

from mocapd.errors import ConfigError, UnavailableError

if TYPE_CHECKING:
    from mocapd.config.effective import Effective
    from mocapd.web.runtime_file import Running


def target_page(effective: "Effective") -> "Running":
    """The addressed daemon with a page, of this user. Raises UnavailableError or ConfigError."""
    from mocapd.config.runtime_folder import runtime_folder
    from mocapd.control.target_process import other_name_error, select_targets
    from mocapd.web.runtime_file import running

    # a setup without a daemon has no name
    pages = [page for page in running(runtime_folder(effective.config.state_dir)) if page.instance]
    chosen = select_targets(pages, effective)
    if pages and not chosen:
        raise other_name_error(effective.chosen_instance, pages)
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
