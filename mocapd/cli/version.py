"""`mocapd version`, and `mocapd --version`."""

from typing import Annotated

import typer

import mocapd


def version() -> None:
    """Print the version.

    Example: mocapd version
    """
    print(mocapd.__version__)


def _print_version(wanted: bool) -> None:
    if wanted:
        version()
        raise typer.Exit


def options(
    _version: Annotated[
        bool,
        typer.Option(
            "--version", help="Print the version.", callback=_print_version, is_eager=True
        ),
    ] = False,
) -> None:
    """Webcams in, a body pose out, over Zenoh and OSC."""
