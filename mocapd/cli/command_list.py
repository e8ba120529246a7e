"""The list of commands, one file each. A file imports heavy modules only when its command runs."""

import typer

from mocapd.cli import (
    bench,
    board,
    calibrate,
    camera_node_command,
    cameras,
    check_config,
    demo,
    prepare,
    recenter,
    run,
    send_test,
    shirt,
    track,
    version,
    watch,
    web_link,
)
from mocapd.cli import eval as evaluation
from mocapd.cli.care import completion, doctor, man, reload, status
from mocapd.cli.recordings import export, record, replay
from mocapd.cli.service import as_service, install_service

app = typer.Typer(
    name="mocapd",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
for command in (
    run,
    demo,
    record,
    replay,
    export,
    track,
    evaluation,
    bench,
    watch,
    status,
    doctor,
    reload,
    recenter,
    web_link,
    send_test,
    cameras,
    camera_node_command,
    check_config,
    prepare,
    install_service,
    as_service,
    version,
    completion,
    man,
):
    command.add_to(app)
calibrate.add_to(app)
for printable in (board, shirt):
    printable.add_to(app)
