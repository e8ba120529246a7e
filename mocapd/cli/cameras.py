"""`mocapd cameras`"""

import json
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.errors import one_line

if TYPE_CHECKING:
    from mocapd.capture.webcam.v4l2_ioctl import PixelFormat
    from mocapd.capture.webcam.webcam_listing import CameraInfo


def cameras(
    as_json: Annotated[bool, typer.Option("--json", help="One JSON object a camera.")] = False,
    at: Annotated[
        str | None,
        typer.Option(
            help="List those of a camera node instead, or of all behind a Zenoh router.",
            metavar="zenohs://[USER@]HOST[:PORT][/NODE][?ca=FILE]",
        ),
    ] = None,
) -> None:
    """List the webcams, with the reason if one cannot be used.

    Each with node, name, vid:pid:serial, USB port and formats. The `source` of a camera goes into the config. If --at has a
    user without a password, the command asks for it, or reads it from the input.

    Example: mocapd cameras
    """
    if at is not None:
        _print_remote(at, as_json)
        return
    from mocapd.capture.webcam.webcam_listing import list_cameras

    found = list_cameras()
    for info in found:
        print(json.dumps(_as_dict(info)) if as_json else _as_text(info))
    if not found and not as_json:
        typer.echo("mocapd: no webcam found -- plug one in, or see `mocapd demo`", err=True)


def _print_remote(place: str, as_json: bool) -> None:
    import msgspec

    from mocapd.capture.remote.remote_listing import list_remote

    for one in list_remote(_with_password(place)):
        state = one.state
        if as_json:
            print(json.dumps({"source": one.spec, **msgspec.to_builtins(state)}))
            continue
        width, height = state.size_px
        how = f"{width}x{height} {state.rate_hz:.1f} Hz" if state.state == "live" else state.state
        lines = [f"{state.node}/{state.camera}  {how}", f"source  {one.spec}"]
        if state.reason:
            lines.append(f"cannot be used: {state.reason}")
        if not state.can_set:
            lines.append(
                "note    its controls cannot be set from here: node.paired_user of its node"
            )
        print("\n    ".join(map(one_line, lines)))


def _with_password(place: str) -> str:
    """The address with a password from a prompt: every user can read a command line."""
    import sys
    from getpass import getpass
    from urllib.parse import quote

    from mocapd.boundary.urls import split_url

    parts = split_url(place)
    if parts.username is None:
        return place
    if parts.password is not None:
        typer.echo(
            "mocapd: the password stands on the command line, which every user of this machine can read: leave it out,"
            " and it is asked for",
            err=True,
        )
        return place
    user, _, host = parts.netloc.rpartition("@")
    asks = sys.stdin.isatty()
    password = getpass(f"password of {user} at {host}: ") if asks else sys.stdin.readline()
    return parts._replace(
        netloc=f"{user}:{quote(password.rstrip(chr(10)), safe='')}@{host}"
    ).geturl()


def _as_dict(info: "CameraInfo") -> dict[str, object]:
    return {
        "node": str(info.node) if info.node else None,
        "name": info.name,
        "usb_id": info.usb_id,
        "port": info.port_path,
        "source": info.spec,
        "formats": [_format(one) for one in info.formats],
        "usable": info.usable,
        "problem": info.problem,
        "fix": info.fix,
        "note": info.note,
    }


def _as_text(info: "CameraInfo") -> str:
    lines = [f"{info.node or '(no node)'}  {info.name}"]
    if info.usb_id:
        lines.append(f"usb     {info.usb_id} in port {info.port_path}")
    lines.append(f"source  {info.spec}")
    lines += [f"format  {_format(one)}" for one in info.formats]
    if info.problem:
        lines.append(f"cannot be used: {info.problem} -- {info.fix}")
    if info.note:
        lines.append(f"note    {info.note}")
    return "\n    ".join(map(one_line, lines))


def _format(one: "PixelFormat") -> str:
    rates = "/".join(f"{rate:g}" for rate in one.rates_hz)
    return f"{one.fourcc} {one.size_px[0]}x{one.size_px[1]}" + (f" {rates} Hz" if rates else "")
