"""`mocapd as-service`"""

from typing import Annotated

import typer


def as_service(
    words: Annotated[
        list[str], typer.Argument(help="What follows `mocapd`.", metavar="COMMAND...")
    ],
    rig: Annotated[
        str, typer.Option("--rig", help="That of mocapd@NAME.service.", metavar="NAME")
    ] = "",
) -> None:
    """Run a command as the installed service's user, with its configuration and directories.

    So it finds the running service: to set it up, to recenter, to look at what it would be configured to.

    Example: sudo mocapd as-service calibrate
    """
    from mocapd.app.install.service_user import become

    become(rig, words)
