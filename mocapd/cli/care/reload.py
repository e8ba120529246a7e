"""`mocapd reload`"""

import typer

from mocapd.cli.options import ConfigOption, SetOption, config_to_look_after


def add_to(app: typer.Typer) -> None:
    """Register the command."""
    app.command("reload")(reload)


def reload(config: ConfigOption = None, settings: SetOption = None) -> None:
    """Have the running daemon read its config again.

    And its calibration, from the same file as at its start. The stream continues, except while cameras are closed and
    opened. All of it is checked first: an error names its key, and the daemon continues unchanged; the exit code is
    then that of `mocapd run`, such as 78. Changes that need a restart are named.

    Example: mocapd reload
    """
    from mocapd.control.target_process import target_daemon

    daemon = target_daemon(config_to_look_after(config, settings)[0].config)
    done = daemon.reload()
    print(f"{daemon.instance}: taken up, {done.gap_s:.2f} s without a frame")
    if done.waiting:
        print(f"changed, but only for the next start: {', '.join(done.waiting)}")
