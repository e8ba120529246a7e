"""`mocapd run`"""

import logging
import os
from contextlib import ExitStack, closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from mocapd.app.daemon.unsafe_settings import unsafe_settings
from mocapd.cli.options import (
    CameraOption,
    CaptureOption,
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


def run(
    config: ConfigOption = None,
    settings: SetOption = None,
    cameras: CameraOption = None,
    capture: CaptureOption = None,
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
    """Run the daemon and return its exit code. `read` gives the configuration, now and at each reload. `hint` is logged
    once the daemon runs."""
    from mocapd.app.libraries import prepare_libraries
    from mocapd.app.terminal.logs import set_up_logs

    effective = read()
    config = effective.config
    set_up_logs(config.log_level)
    prepare_libraries(config.cache_dir)
    for line in unsafe_settings(effective):
        _log.warning("unsafe: %s", line)

    from mocapd.app.daemon.abort_traces import AbortTraces
    from mocapd.app.daemon.daemon_page import DaemonPage
    from mocapd.app.daemon.early_start import EarlyStart
    from mocapd.app.daemon.initial_session import first_session
    from mocapd.app.daemon.main_loop import END_S, LoopHook, Signals, end_despite_work, run_daemon
    from mocapd.app.daemon.notifier import Notifier
    from mocapd.app.daemon.session_change import SessionChange
    from mocapd.app.daemon.shared_state import SharedState
    from mocapd.app.daemon.supervision import Supervision
    from mocapd.capture.decoder_warnings import DecoderWarnings
    from mocapd.config.runtime_folder import runtime_folder
    from mocapd.control.daemon_control import DaemonControl
    from mocapd.control.last_trouble import LastTrouble
    from mocapd.control.socket_place import socket_path
    from mocapd.service.open_outputs import OpenOutputs
    from mocapd.service.service import Service

    traces = AbortTraces()
    signals = Signals(reloads=True, within_s=END_S)
    notifier = Notifier.of_environment()
    outputs = OpenOutputs(config)
    page = None
    try:
        path = socket_path(runtime_folder(config.state_dir), os.getpid())
        with (
            closing(notifier),
            LastTrouble() as trouble,
            DaemonControl(path, config, outputs, trouble) as control,
            outputs,
            ExitStack() as held,
        ):
            first = first_session(config, outputs, notifier, held, control.open, control.preparing)
            service = Service(first.config, first.session, outputs)
            page = DaemonPage(service) if config.web.enabled else None
            change = SessionChange(service, read, signals, page, notifier)
            control.attach(service, change.reloads)
            traces.start()  # a thread, so not before the forks of the first start
            with DecoderWarnings():  # one, too

                def tell(text: str) -> None:
                    control.preparing(text)
                    service.preparing = text

                hooks: list[LoopHook] = [change, control, Supervision(notifier)]
                if page is not None:  # else it has no setup
                    hooks.append(SharedState(config))
                if first.is_early:
                    hooks.append(EarlyStart(first.preparation, change, tell))
                code = run_daemon(service, signals, hint, hooks, control.what_is_prepared)
    except SystemExit as end:  # a signal ended it during the preparation of the first session
        code = end.code if isinstance(end.code, int) else 0
    finally:
        if page is not None:
            page.close()
    end_despite_work(code)
    return code
