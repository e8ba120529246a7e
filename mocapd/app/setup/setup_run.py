"""Implementation of `mocapd calibrate` with its page: attached to a running daemon, or with its own cameras."""

import os
import shlex
import threading
import time
import traceback
import webbrowser
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from mocapd.errors import ConfigError, UsageError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from mocapd.app.daemon.main_loop import Signals
    from mocapd.config.effective import Effective
    from mocapd.config.sections import Config
    from mocapd.web.runtime_file import Place, Running
    from mocapd.wizard.step_names import StepName

LOOK_EVERY_S = 0.25
HANG_UP_S = 0.5  # for browsers, at the end [s]
STAY_S = 6.0  # after Save, so that the page can say so [s]


@dataclass(frozen=True, slots=True)
class PageOptions:
    """step: a single step to run; own_place: True if the command line gave the state directory."""

    step: str | None
    demo: bool
    own_place: bool
    browser: bool


def calibrate_page(options: PageOptions, effective: "Effective") -> int:
    """Runs the setup until it is saved or a signal ends it; returns the exit code. Raises MocapdError."""
    from mocapd.app.libraries import prepare_libraries
    from mocapd.app.terminal.logs import set_up_logs

    config = effective.config
    set_up_logs(config.log_level)
    prepare_libraries(config.cache_dir)

    from mocapd.boundary.folders import require_writable
    from mocapd.config.runtime_folder import runtime_folder
    from mocapd.control.target_process import other_name_error, select_targets
    from mocapd.web.runtime_file import SETUP, Place, begin_setup, running

    step = _step(options.step)
    folder = runtime_folder(config.state_dir)
    pages = () if options.demo else running(folder)
    if pages:
        chosen = select_targets(pages, effective)
        if not chosen:
            raise other_name_error(effective.chosen_instance, pages)
        there = _the_one(chosen)
        begin_setup(there.url, None if step is None else step.value)
        print(f"the running mocapd has the cameras; its page: {there.url}{SETUP}", flush=True)
        _browse(there.redirect, options.browser)
        return 0
    if options.demo and not options.own_place:
        config = replace(config, state_dir=config.state_dir / "demo")
    if step != "check":  # which saves nothing
        require_writable(config.state_dir, "state_dir")
    place = Place(folder, config.state_dir, config.instance, findable=not options.demo)
    from mocapd.app.daemon.cache_warmup import database_in_background
    from mocapd.app.daemon.main_loop import Signals, end_despite_work

    signals = Signals()  # before the background work, so that a signal ends both
    with database_in_background(config):
        code = _alone(options, config, step, place, signals)
    end_despite_work(code)
    return code


def _the_one(pages: "Sequence[Running]") -> "Running":
    """The only page. Raises ConfigError for several."""
    from mocapd.web.runtime_file import SETUP

    if len(pages) == 1:
        return pages[0]
    names = [f"{page.instance or 'a setup'} (pid {page.pid})" for page in pages]
    for name, page in zip(names, pages, strict=True):
        print(f"{name}: {page.url}{SETUP}", flush=True)
    raise ConfigError(
        f"several are running: {', '.join(names)}",
        "command line",
        "open one of these addresses, or choose by --set instance=NAME or --state-dir",
    )


def _alone(
    options: PageOptions,
    config: "Config",
    step: "StepName | None",
    place: "Place",
    signals: "Signals",
) -> int:
    from mocapd.app.daemon.main_loop import INTERNAL_ERROR
    from mocapd.app.setup.setup_hosts import demo_host, webcam_host
    from mocapd.latch import ThreadDiedError
    from mocapd.web.runtime_file import SETUP
    from mocapd.web.server import WebServer

    following = next_command(config.state_dir, usual=not (options.demo or options.own_place))
    host = (demo_host if options.demo else webcam_host)(config, step, following)
    # an exception in any thread must end the process
    threading.excepthook = lambda args: host.on_thread_died(
        args.exc_value or RuntimeError(args.exc_type)
    )
    signals.ends(host)
    server = WebServer(host, config.web, host.on_thread_died, place)
    try:
        server.start()
        host.start()
        print(f"set up mocapd at {server.url}{SETUP}", flush=True)
        _browse(server.redirect, options.browser)
        until_s = float("inf")
        while not host.wait(LOOK_EVERY_S) and time.monotonic() < until_s:
            if host.is_saved and until_s == float("inf"):
                until_s = time.monotonic() + STAY_S
                print(_what_next(config.state_dir, following), flush=True)
        if host.is_saved and until_s == float("inf"):  # ended in the moment it was saved
            print(_what_next(config.state_dir, following), flush=True)
    except ThreadDiedError as error:
        traceback.print_exception(error.__cause__)
        return INTERNAL_ERROR
    finally:
        server.let_go()
        host.stop()
        server.stop(HANG_UP_S)
    return signals.exit_code


def next_command(state_dir: Path, *, usual: bool) -> str:
    """The command that starts the daemon with the saved calibration; usual: in the default folder."""
    from mocapd.calibration.calibration_file import FILE_NAME

    return (
        "mocapd run"
        if usual
        else shlex.join(["mocapd", "run", "--rig", str(state_dir / FILE_NAME)])
    )


def _what_next(state_dir: Path, following: str) -> str:
    from mocapd.calibration.calibration_file import FILE_NAME

    return f"saved {state_dir / FILE_NAME}; now: {following}"


def _step(name: str | None) -> "StepName | None":
    from mocapd.wizard.step_names import StepName

    if name is None:
        return None
    if name not in tuple(StepName):
        raise UsageError(f"--step {name}", "command line", f"one of: {', '.join(StepName)}")
    return StepName(name)


def _browse(redirect: Path | None, wanted: bool) -> None:
    """Opens the browser on a desktop, by a file that redirects to the page: the address holds the token, and every user
    can read a command line."""
    if not wanted or redirect is None:
        return
    if os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"):
        webbrowser.open(redirect.resolve().as_uri())
        # one from a snap or a flatpak may not read that file
        print("should the browser not show it, open that address in it", flush=True)
