"""`mocapd version`"""

import typer

import mocapd


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("version")(version)


def version() -> None:
    """Print the version.

    Example: mocapd version
    """
    print(mocapd.__version__)
