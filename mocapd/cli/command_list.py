"""The list of commands, one file each. A file imports heavy modules only when its command runs."""

from collections.abc import Callable

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
from mocapd.cli.command_line.option_groups import spread_options
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
# what follows `as-service` is another command's
_CONTEXT = {"as-service": {"ignore_unknown_options": True, "allow_interspersed_args": False}}
_COMMANDS: dict[str, Callable[..., None]] = {
    "run": run.run,
    "demo": demo.demo,
    "record": record.record,
    "replay": replay.replay,
    "export": export.export,
    "track": track.track,
    "eval": evaluation.evaluate_captures,
    "bench": bench.bench_command,
    "watch": watch.watch,
    "status": status.status,
    "doctor": doctor.doctor,
    "reload": reload.reload,
    "recenter": recenter.recenter,
    "web-link": web_link.web_link,
    "send-test": send_test.send_test_command,
    "cameras": cameras.cameras,
    "camera-node": camera_node_command.camera_node,
    "check-config": check_config.check_config,
    "prepare": prepare.prepare,
    "install-service": install_service.install_service,
    "uninstall-service": install_service.uninstall_service,
    "as-service": as_service.as_service,
    "version": version.version,
    "completion": completion.completion,
    "man": man.man,
    "calibrate": spread_options(calibrate.calibrate),
    "board": board.board,
    "shirt": shirt.shirt,
}
app.callback()(version.options)
for name, command in _COMMANDS.items():
    app.command(name, context_settings=_CONTEXT.get(name))(command)
