"""`mocapd status`"""

import json
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.cli.options import ConfigOption, SetOption, config_to_look_after
from mocapd.cli.watch import link_of

if TYPE_CHECKING:
    from mocapd.client import Link
    from mocapd.control.control_messages import StatusReport

# Exit codes of an init script's `status` (LSB); 150 to 199 are application-specific.
ABLE = 0
NOT_RUNNING = 3
UNKNOWN = 4
UNABLE = 150
SLOW = 151


def status(
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a daemon.")] = False,
    config: ConfigOption = None,
    settings: SetOption = None,
    every: Annotated[
        bool, typer.Option("--all", help="Every daemon on the Zenoh bus, also of other machines.")
    ] = False,
    endpoint: Annotated[
        str | None,
        typer.Option(help="With --all: the router, or a daemon [default: that of the config]"),
    ] = None,
) -> None:
    """Print the state of the running daemon.

    State, tracker, rate, latency, cameras, outputs, calibration, last trouble. If several daemons run, it shows the one
    of this configuration, else all.

    Exit code: 0 tracks or waits for a person; 150 cannot track (still starting, or no camera delivers); 151 too slow
    (skips many pictures); 3 no daemon runs; 4 no answer, or the daemon of another user. With --all it is the worst on
    the bus.

    Example: mocapd status --json | jq .state
    """
    from mocapd.app.terminal.status_text import status_lines
    from mocapd.control.target_process import find_daemons, no_daemon_error, select_targets

    effective, error = config_to_look_after(config, settings)
    chosen = effective.config
    if every:
        from mocapd.outputs.output_table import zenoh_section

        raise typer.Exit(_print_all(link_of(zenoh_section(chosen.outputs), endpoint), as_json))
    found = find_daemons(chosen)
    reports = [one.status for one in select_targets(found.daemons, effective)]
    for report in reports:
        print(_as_json(report) if as_json else "\n".join(status_lines(report)))
    if not reports:
        typer.echo(f"mocapd: {no_daemon_error(found, chosen)}", err=True)
        raise typer.Exit(UNKNOWN if found.silent or found.foreign else NOT_RUNNING)
    if error is not None:
        typer.echo(f"mocapd: the next start or reload will not do: {error}", err=True)
    raise typer.Exit(max(map(exit_code, reports)))


def _print_all(link: "Link", as_json: bool) -> int:
    """The exit code."""
    from mocapd.app.terminal.watch_all import as_dict, as_text, is_able, on_the_bus
    from mocapd.errors import UnavailableError

    try:
        states = on_the_bus(link)
    except UnavailableError as error:
        typer.echo(f"mocapd: {error}", err=True)
        return NOT_RUNNING
    for one in states:
        print(json.dumps(as_dict(one)) if as_json else as_text(one))
    return ABLE if all(map(is_able, states)) else UNABLE


def exit_code(report: "StatusReport") -> int:
    """The exit code for one daemon that answers."""
    if report.state == "slow":
        return SLOW
    return ABLE if report.state in ("tracking", "nobody") else UNABLE


def _as_json(report: "StatusReport") -> str:
    import msgspec

    return json.dumps(msgspec.to_builtins(report))
