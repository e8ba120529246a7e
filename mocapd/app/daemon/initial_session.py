"""Prepares the first session of a daemon after opening its outputs, in a thread, so that signals end the main thread."""

import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import ExitStack
from dataclasses import dataclass, replace

from mocapd.app.daemon.cache_warmup import Preparation, prepare_in_background
from mocapd.app.daemon.heap import give_back
from mocapd.app.daemon.notifier import Notifier
from mocapd.app.terminal.progress import ProgressBars
from mocapd.config.sections import Config
from mocapd.service.open_outputs import OpenOutputs
from mocapd.session.session import Session, SessionPlan, open_planned, plan_session

PREPARATION_TIMEOUT_S = 1800.0  # a first start on a slow machine, or behind another daemon's [s]
_LOOK_S = 0.2  # poll interval of the main thread, which signals may interrupt [s]
_EARLY_TRACKER = "shirt"

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class FirstSession:
    """`session` and its configuration. is_early: the configured one follows when `preparation` is over."""

    session: Session
    config: Config
    preparation: Preparation
    is_early: bool


def first_session(
    config: Config,
    outputs: OpenOutputs,
    notifier: Notifier,
    held: ExitStack,
    on_open: Callable[[], None] = lambda: None,
    on_progress: Callable[[str], None] = lambda _: None,
) -> FirstSession:
    """Opens the outputs, calls `on_open`, and prepares the session; reports to `on_progress`. A remaining preparation ends
    with `held`. Call it in the main thread, while it is the only one. Raises the errors of outputs and session.

    A signal's exception leaves a thread running: see `end_despite_work`.
    """

    def report(text: str) -> None:
        notifier.status(text)
        on_progress(text)

    plan = plan_session(config)
    try:
        preparation = held.enter_context(prepare_in_background(config))
        outputs.open()
        on_open()
        notifier.ready(
            "compiling the tracker, once on this machine"
            if preparation.is_needed
            else "preparing the tracker"
        )
        notifier.extend_watchdog(PREPARATION_TIMEOUT_S)
        preparation.wait(report)
        is_early = not preparation.is_over
        if is_early:
            config = replace(config, tracker=replace(config.tracker, name=_EARLY_TRACKER))
            plan = plan_session(config)
            _log.info(
                "the stream begins with the shirt; legs, head and other clothes follow when they are prepared"
            )
        report("preparing the tracker")
        session = _open_in_thread(plan, is_early)
    except BaseException:
        notifier.stopping()
        raise
    notifier.restore_watchdog()
    on_progress("")
    return FirstSession(session, config, preparation, is_early)


def _open_in_thread(plan: SessionPlan, is_early: bool) -> Session:
    pool = ThreadPoolExecutor(1, "first-session")
    try:
        opening = pool.submit(_open, plan, is_early)
        while wait((opening,), _LOOK_S).not_done:
            pass  # a signal may interrupt here
        session = opening.result()
    finally:
        pool.shutdown(wait=False)
    give_back()
    return session


def _open(plan: SessionPlan, is_early: bool) -> Session:
    with ProgressBars() as progress:
        return open_planned(plan, progress, is_early)
