"""`mocapd demo`"""

import shlex
import shutil
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from mocapd.cli.options import ConfigOption, SetOption, VrmOption, effective_config, vrm_flags
from mocapd.cli.run import run_with

if TYPE_CHECKING:
    from mocapd.config.effective import Effective
    from mocapd.config.sections import Config

SCENARIO = "sim:living_room"


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("demo")(demo)


def demo(config: ConfigOption = None, settings: SetOption = None, vrm: VrmOption = None) -> None:
    """Run the daemon on two simulated webcams.

    They show a person in the shirt in a furnished room with two coloured lamps, one of which goes
    out in each loop. Publishes on Zenoh and OSC on 127.0.0.1.

    Example: mocapd demo
    """

    def read() -> "Effective":
        return effective_config(config, settings, None, SCENARIO, **vrm_flags(vrm))

    watch = watch_command(read().config)
    raise typer.Exit(run_with(read, f"in a second terminal: {watch}"))


def watch_command(config: "Config") -> str:
    """The command line that shows the stream of this configuration, to be pasted anywhere."""
    from mocapd.outputs.registry import ZenohSection, zenoh_section

    beside = Path(sys.executable).parent / "mocapd"
    on_path = shutil.which("mocapd")
    name = "mocapd" if on_path and Path(on_path) == beside else str(beside)
    words = [name, "watch"]
    port = zenoh_section(config.outputs).port
    if port != ZenohSection().port:
        words += ["--set", f"zenoh.port={port}"]
    return shlex.join(words)
