"""`mocapd run`"""

import logging
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.app.unsafe_settings import unsafe_settings
from mocapd.cli.options import (
    CameraOption,
    ConfigOption,
    SetOption,
    VrmOption,
    effective_config,
    vrm_flags,
)

if TYPE_CHECKING:
    from collections.abc import Callable

    from mocapd.config.effective import Effective

_log = logging.getLogger(__name__)


def add_to(app: typer.Typer) -> None:
    """Make it a command."""
    app.command("run")(run)


def run(
    config: ConfigOption = None,
    settings: SetOption = None,
    cameras: CameraOption = None,
    capture: Annotated[
        str | None,
        typer.Option(help="All cameras of a capture folder, or of sim:SCENARIO.", metavar="FOLDER"),
    ] = None,
    rig: Annotated[Path | None, typer.Option(help="The rig file: the calibration.")] = None,
    tracker: Annotated[str | None, typer.Option(help="Which tracker.")] = None,
    instance: Annotated[str | None, typer.Option(help="This daemon's name in the keys.")] = None,
    vrm: VrmOption = None,
) -> None:
    """Run the daemon in the foreground.

    Ends with SIGTERM (exit code 0), Ctrl-C (130), or when every recording has ended. SIGHUP has it read
    its configuration again, unless it has a terminal: there it ends.

    Example: mocapd run --rig rig.json --camera left=/dev/video0 --camera right=/dev/video2
    """
    flags = {
        "rig": None if rig is None else str(rig),
        "tracker__name": tracker,
        "instance": instance,
        **vrm_flags(vrm),
    }
    raise typer.Exit(
        run_with(lambda: effective_config(config, settings, cameras, capture, **flags))
    )


def run_with(read: "Callable[[], Effective]", hint: str = "") -> int:
    """Run with the configuration that is read, now and whenever it is to be read again, until it ends; the
    exit code. `hint` is logged once it runs."""
    from mocapd.app.libraries import prepare_libraries
    from mocapd.app.logs import set_up_logs

    effective = read()
    config = effective.config
    set_up_logs(config.log_level)
    prepare_libraries(config.cache_dir)
    for line in unsafe_settings(effective):
        _log.warning("unsafe: %s", line)

    from mocapd.app.daemon_page import DaemonPage
    from mocapd.app.first_start import prepare_apart
    from mocapd.app.progress import ProgressBars
    from mocapd.app.running import Signals, end_despite_work, run_daemon
    from mocapd.app.session_change import SessionChange
    from mocapd.service.service import Service
    from mocapd.session.session import open_session

    signals = Signals(reloads=True)
    prepare_apart(config)
    with ProgressBars() as progress:
        service = Service(config, open_session(config, progress))
    page = DaemonPage(service) if config.web.enabled else None
    try:
        code = run_daemon(service, signals, hint, SessionChange(service, read, signals, page))
    finally:
        if page is not None:
            page.close()
    end_despite_work(code)
    return code
