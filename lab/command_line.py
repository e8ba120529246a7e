"""What the commands of `lab/` share: options, errors as one line, and the words that repeat a command."""

import os
import shlex
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated

import typer

from mocapd.app.libraries import prepare_libraries
from mocapd.cli.eval import Joints
from mocapd.cli.options import effective_config
from mocapd.config.sections import Config
from mocapd.errors import MocapdError

TrackerOption = Annotated[
    str | None, typer.Option("--tracker", help="Which tracker [default: that of the config]")
]
JsonOption = Annotated[bool, typer.Option("--json", help="One JSON object.")]
OutOption = Annotated[
    Path | None,
    typer.Option(
        "--out", help="Write the page and its plots into this folder, in place of earlier ones."
    ),
]
JointsOption = Annotated[Joints, typer.Option("--joints", help="Which joints are scored.")]


def run(command: Callable[..., None]) -> None:
    """Run a function as the command line of its module. An expected trouble is one line on stderr; its code is the exit
    code."""
    app = typer.Typer(add_completion=False)
    app.command()(command)
    try:
        app()
    except MocapdError as error:
        sys.stderr.write(f"lab: {error}\n")
        sys.exit(error.exit_code)


def prepared_config(
    config: Path | None, settings: list[str] | None, tracker: str | None = None
) -> Config:
    """The configuration with these flags on top, its cache folder made. Raises ConfigError, CannotCreateError."""
    effective = effective_config(config, settings, tracker__name=tracker).config
    prepare_libraries(effective.cache_dir)
    return effective


def repeat(module: str, *words: str | Path) -> str:
    """The command that repeats a run from the same folder, in which paths are relative."""
    given = [os.path.relpath(word) if isinstance(word, Path) else word for word in words]
    return shlex.join(["python", "-m", module, *given])


def tell_written(paths: Sequence[Path]) -> None:
    """Name the files on stderr."""
    for path in paths:
        sys.stderr.write(f"{path}: written\n")
