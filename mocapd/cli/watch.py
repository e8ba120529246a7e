"""`mocapd watch`"""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.cli.options import ConfigOption, SetOption, effective_config
from mocapd.errors import one_line

if TYPE_CHECKING:
    from mocapd.client import Body, Link
    from mocapd.outputs.output_table import ZenohSection

SHOWN = ("head", "leftHand", "rightHand", "hips")


def watch(
    config: ConfigOption = None,
    settings: SetOption = None,
    endpoint: Annotated[
        str | None,
        typer.Option(help="Zenoh endpoint of the daemon [default: that of the config]"),
    ] = None,
    instance: Annotated[str, typer.Option(help="Name of the daemon; *: any.")] = "*",
    every: Annotated[
        bool, typer.Option("--all", help="Every daemon on the bus in one line, once a second.")
    ] = False,
    as_json: Annotated[
        bool, typer.Option("--json", help="One JSON object a frame; with --all: a daemon.")
    ] = False,
    count: Annotated[
        int,
        typer.Option(
            "--count",
            min=0,
            help="Stop after this number of frames or, with --all, seconds; 0: never.",
        ),
    ] = 0,
    timeout_s: Annotated[
        float, typer.Option("--timeout", min=0.0, help="How long to look for a daemon [s].")
    ] = 5.0,
) -> None:
    """Print the frames of a running daemon.

    It subscribes like any client, with the certificate and user of the configuration ([zenoh]), and skips to the
    newest frame. With --all it prints the health messages of all daemons on the bus in place of frames.

    Example: mocapd watch --json | head -n 1
    """
    from mocapd.client import Client
    from mocapd.outputs.output_table import zenoh_section

    zenoh = zenoh_section(effective_config(config, settings).config.outputs)
    link = link_of(zenoh, endpoint, instance, timeout_s)
    if every:
        from mocapd.app.terminal.watch_all import watch_all

        watch_all(link, as_json, count)
        return
    with Client(link) as client:
        for number, body in enumerate(client, start=1):
            print(_as_json(body) if as_json else _as_text(body), flush=True)
            if number == count:
                return


def link_of(
    zenoh: "ZenohSection",
    endpoint: str | None = None,
    instance: str = "*",
    timeout_s: float = 2.0,
) -> "Link":
    """Zenoh parameters for a client of a daemon or its router; endpoint: None: that of this configuration. Uses the
    configuration's certificate and the first user of its password file."""
    from mocapd.client import Link
    from mocapd.outputs.zenoh.zenoh_config import listen_endpoints
    from mocapd.outputs.zenoh.zenoh_password_file import first_login

    user, password = first_login(Path(zenoh.password_file)) if zenoh.password_file else ("", "")
    return Link(
        endpoint or (zenoh.connect or listen_endpoints(zenoh))[0],
        instance,
        connect_timeout_s=timeout_s,
        tls_root_ca=zenoh.tls_root_ca,
        user=user,
        password=password,
        # both or none: Zenoh asks for the key of a certificate
        certificate=zenoh.tls_certificate if zenoh.tls_private_key else "",
        private_key=zenoh.tls_private_key if zenoh.tls_certificate else "",
        typed_options=True,
    )


def _as_json(body: "Body") -> str:
    import msgspec

    return json.dumps(msgspec.to_builtins(body.frame))


def _as_text(body: "Body") -> str:
    frame = body.frame
    line = (
        f"{frame.instance} #{frame.seq} {frame.tracker} {body.tracking:<8} "
        f"{1e3 * body.latency_s:5.1f} ms  {'+'.join(frame.cameras)}"
    )
    for name in SHOWN:
        if name in body:
            x, y, z = body[name].position_m
            line += f"  {name} {x:+.2f} {y:+.2f} {z:+.2f}"
    return one_line(line)
