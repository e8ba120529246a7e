"""`mocapd send-test`"""

from typing import Annotated

import typer

from mocapd.cli.options import ConfigOption, SetOption, VrmOption, effective_config, vrm_flags
from mocapd.errors import UsageError


def send_test_command(
    output: Annotated[
        str, typer.Option("--output", help="Which output: zenoh, osc, vmc, vrchat or vmt.")
    ],
    host: Annotated[
        str | None,
        typer.Option(help="Send there: an address or a name [default: that of the config]"),
    ] = None,
    port: Annotated[
        int | None, typer.Option(min=1, max=65535, help="And to this port, UDP or Zenoh's TCP.")
    ] = None,
    seconds: Annotated[float, typer.Option(min=0.1, max=86_400.0, help="How long [s].")] = 10.0,
    config: ConfigOption = None,
    settings: SetOption = None,
    vrm: VrmOption = None,
) -> None:
    """Send a waving and stepping person to an output, without cameras: to test firewall and avatar.

    Exit code: 0 if a program listens, 1 if none does. Other machines may not report the latter.
    With Zenoh, --port is the port for games to connect to, and --host the address of a router to join, by the protocol of
    zenoh.connect.

    Example: mocapd send-test --output vrchat --host 192.168.1.20
    """
    from mocapd.app.libraries import prepare_libraries
    from mocapd.app.terminal.logs import set_up_logs
    from mocapd.outputs.instance import instance_name
    from mocapd.outputs.output_table import OUTPUTS

    if output not in OUTPUTS:
        raise UsageError(
            f"there is no output {output[:100]!r}", "--output", f"one of: {', '.join(OUTPUTS)}"
        )
    effective = effective_config(config, settings, None, None, **vrm_flags(vrm)).config
    set_up_logs(effective.log_level)
    prepare_libraries(effective.cache_dir)
    entry, section = OUTPUTS[output], effective.outputs[output]
    if host is not None or port is not None:
        section = entry.override_address(section, host, port)

    from mocapd.app.terminal.send_test_run import send_test

    instance = instance_name(effective.instance)
    raise typer.Exit(send_test(entry.build(section, instance), instance, seconds))
