"""`mocapd demo`"""

import shlex
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.app.terminal.own_command import own_command
from mocapd.cli.options import ConfigOption, SetOption, VrmOption, effective_config, vrm_flags
from mocapd.cli.run import run_with

if TYPE_CHECKING:
    from mocapd.config.effective import Effective
    from mocapd.config.sections import Config

SCENARIO = "living_room"


def demo(
    config: ConfigOption = None,
    settings: SetOption = None,
    vrm: VrmOption = None,
    scenario: Annotated[
        str, typer.Option(help="Another scene, such as jacket, or a scenario file (.toml).")
    ] = SCENARIO,
) -> None:
    """Run the daemon on two simulated webcams.

    They show a person in the shirt in a furnished room with two coloured lamps, one of which goes
    out in each loop; in the scene `jacket` a jacket is put on over the shirt, and the tracker that needs
    no shirt goes on. Publishes on Zenoh and OSC on 127.0.0.1.

    Example: mocapd demo --scenario jacket
    """
    from mocapd.capture.simulated.sim_kind import scenario_address

    def read() -> "Effective":
        origin = scenario_address(scenario)
        return effective_config(config, settings, None, origin, **vrm_flags(vrm))

    watch = watch_command(read().config)
    raise typer.Exit(run_with(read, watch and f"in a second terminal: {watch}"))


def watch_command(config: "Config") -> str:
    """The command line that shows the stream of this configuration, for any terminal; empty without Zenoh."""
    from mocapd.outputs.output_table import ZenohSection, zenoh_section

    if not zenoh_section(config.outputs).enabled:
        return ""
    words = [own_command(), "watch"]
    port = zenoh_section(config.outputs).port
    if port != ZenohSection().port:
        words += ["--set", f"zenoh.port={port}"]
    return shlex.join(words)
