"""`mocapd calibrate` with its page: attached to the running daemon, or with cameras of its own."""

import os
import threading
import time
import traceback
import webbrowser
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from mocapd.errors import ConfigError

if TYPE_CHECKING:
    from mocapd.config_sections import Config
    from mocapd.wizard.step import StepName

SETUP = "#setup"  # the part of the page
LOOK_EVERY_S = 0.25
HANG_UP_S = 0.5  # for browsers, at the end [s]
STAY_S = 6.0  # after Save, so that the page can say so [s]


@dataclass(frozen=True, slots=True)
class PageOptions:
    """step: the one to do; own_place: whether the state directory was named on the command line."""

    step: str | None
    demo: bool
    own_place: bool
    browser: bool


def calibrate_page(options: PageOptions, config: "Config") -> int:
    """Run the setup until it is saved or ended by a signal; the exit code. Raises MocapdError."""
    from mocapd.cli.libraries import prepare_libraries
    from mocapd.cli.logs import set_up_logs

    set_up_logs(config.log_level)
    prepare_libraries(config.cache_dir)

    from mocapd.web.runtime_file import begin_setup, running, runtime_path

    step = _step(options.step)
    announce_at = None if options.demo else runtime_path(config.state_dir)
    there = None if announce_at is None else running(announce_at)
    if there is not None:
        begin_setup(there.url, None if step is None else step.value)
        print(f"the running mocapd has the cameras; its page: {there.url}{SETUP}", flush=True)
        _browse(there.url + SETUP, options.browser)
        return 0
    if options.demo and not options.own_place:
        config = replace(config, state_dir=config.state_dir / "demo")
    from mocapd.cli.first_start import database_beside
    from mocapd.cli.running import end_despite_work

    with database_beside(config):
        code = _alone(options, config, step, announce_at)
    end_despite_work(code)
    return code


def _alone(
    options: PageOptions, config: "Config", step: "StepName | None", announce_at: Path | None
) -> int:
    from mocapd.cli.calibrate_hosts import demo_host, webcam_host
    from mocapd.cli.running import INTERNAL_ERROR, Signals
    from mocapd.daemon import ThreadDiedError
    from mocapd.web.server import WebServer

    signals = Signals()
    host = demo_host(config, step) if options.demo else webcam_host(config, step)
    # a thread nobody watches must not die unseen either
    threading.excepthook = lambda args: host.died(args.exc_value or RuntimeError(args.exc_type))
    signals.ends(host)
    server = WebServer(host, config.web, host.died, announce_at)
    try:
        server.start()
        host.start()
        print(f"set up mocapd at {server.url}{SETUP}", flush=True)
        _browse(server.url + SETUP, options.browser)
        until_s = float("inf")
        while not host.wait(LOOK_EVERY_S) and time.monotonic() < until_s:
            if host.saved and until_s == float("inf"):
                until_s = time.monotonic() + STAY_S
                print(_what_next(config.state_dir, options), flush=True)
    except ThreadDiedError as error:
        traceback.print_exception(error.__cause__)
        return INTERNAL_ERROR
    finally:
        server.let_go()
        host.stop()
        server.stop(HANG_UP_S)
    return signals.exit_code


def _what_next(state_dir: Path, options: PageOptions) -> str:
    from mocapd.calibrate.calibration_file import FILE_NAME

    path = state_dir / FILE_NAME
    usual = not (options.demo or options.own_place)
    command = "mocapd run" if usual else f"mocapd run --rig {path}"
    return f"saved {path}; now: {command}"


def _step(name: str | None) -> "StepName | None":
    from mocapd.wizard.step import StepName

    if name is None:
        return None
    if name not in tuple(StepName):
        raise ConfigError(f"--step {name}", "command line", f"one of: {', '.join(StepName)}")
    return StepName(name)


def _browse(url: str, wanted: bool) -> None:
    """Open the browser where there is a desktop."""
    if wanted and (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        webbrowser.open(url)
