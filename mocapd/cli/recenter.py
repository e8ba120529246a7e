"""`mocapd recenter`"""

from typing import TYPE_CHECKING

import typer

from mocapd.cli.options import ConfigOption, SetOption, effective_config
from mocapd.errors import ConfigError, UnavailableError

if TYPE_CHECKING:
    from mocapd.config.sections import Config
    from mocapd.web.runtime_file import Running


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("recenter")(recenter)


def recenter(config: ConfigOption = None, settings: SetOption = None) -> None:
    """Make the way the person faces now forward, in the running daemon.

    Stand, and look straight ahead, in VR at what shall be ahead there. VRChat then turns the body to the headset.

    Example: mocapd recenter
    """
    from mocapd.web import runtime_file

    told = runtime_file.recenter(_daemon(effective_config(config, settings).config).url)
    side = "left" if told.yaw_deg >= 0.0 else "right"
    print(
        f"forward is {abs(told.yaw_deg):.0f} degrees to the {side} of the room's +Z;"
        f" told to: {', '.join(told.outputs) or 'no output'}"
    )
    if "vrchat" not in told.outputs:
        typer.echo("mocapd: VRChat is not sent to: set vrchat.enabled = true", err=True)


def _daemon(config: "Config") -> "Running":
    """The one that is meant. Raises UnavailableError or ConfigError."""
    from mocapd.app.chosen_page import pages_meant
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
