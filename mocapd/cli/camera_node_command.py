"""`mocapd camera-node`"""

from typing import Annotated

import typer

from mocapd.cli.options import (
    CameraOption,
    CaptureOption,
    ConfigOption,
    SetOption,
    effective_config,
    toml_string,
)


def camera_node(
    config: ConfigOption = None,
    settings: SetOption = None,
    cameras: CameraOption = None,
    capture: CaptureOption = None,
    name: Annotated[
        str | None, typer.Option(help="The node's name [default: that of the machine].")
    ] = None,
    listen: Annotated[
        str | None,
        typer.Option(help="Endpoint to listen on, such as tls/0.0.0.0:7447: zenoh.listen."),
    ] = None,
    connect: Annotated[
        str | None,
        typer.Option(help="Endpoint of a Zenoh router to join, in place of that: zenoh.connect."),
    ] = None,
    imperfect: Annotated[
        str,
        typer.Option(
            help="For tests: a bad clock and network, offset_s= drift_ppm= jitter_ms= loss=.",
            metavar="NAME=NUMBER,...",
        ),
    ] = "",
) -> None:
    """Send the pictures of this machine's webcams to a daemon on another one.

    JPEGs are sent as the cameras deliver them. The command prints the source of each camera for the configuration of
    the daemon. It reads [[camera]], [zenoh] and [node] of its own configuration.

    Example: mocapd camera-node --name attic --camera left=usb:1-3:046d:0825: --listen tls/0.0.0.0:7447
    """
    from mocapd.app.daemon.camera_node_run import run_camera_node

    effective = effective_config(
        config,
        settings,
        cameras,
        capture,
        instance=name,
        zenoh__listen=None if listen is None else f"[{toml_string(listen)}]",
        zenoh__connect=None if connect is None else f"[{toml_string(connect)}]",
    )
    raise typer.Exit(run_camera_node(effective, imperfect))
