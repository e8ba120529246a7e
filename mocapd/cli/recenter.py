"""`mocapd recenter`"""

import typer

from mocapd.cli.options import ConfigOption, SetOption, config_to_look_after
from mocapd.errors import one_line


def recenter(config: ConfigOption = None, settings: SetOption = None) -> None:
    """Set the direction that the person faces now as forward, in the running daemon.

    Stand and look straight ahead; in VR, at the point that should be in front of you. VRChat then turns the body in the
    direction of the headset, SteamVR (vmt) in that of the play area.

    Example: mocapd recenter
    """
    from mocapd.control.target_process import target_daemon

    report = target_daemon(config_to_look_after(config, settings)[0]).recenter()
    side = "left" if report.yaw_deg >= 0.0 else "right"
    told = one_line(", ".join(report.outputs)) or "no output"
    print(
        f"forward is {abs(report.yaw_deg):.0f} degrees to the {side} of the room's +Z; told to: {told}"
    )
    if not {"vrchat", "vmt"} & {*report.outputs}:
        typer.echo(
            "mocapd: neither VRChat nor SteamVR is sent to: set vrchat.enabled = true or vmt.enabled = true",
            err=True,
        )
