"""The first session of a daemon, prepared when its outputs are open, beside the main thread, which a signal ends."""

import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from contextlib import ExitStack
from dataclasses import dataclass, replace

from mocapd.app.daemon.cache_warmup import Preparation, preparing_apart
from mocapd.app.daemon.heap import give_back
from mocapd.app.daemon.notifier import Notifier
from mocapd.app.terminal.progress import ProgressBars
from mocapd.config.sections import Config
from mocapd.service.open_outputs import OpenOutputs
from mocapd.session.session import Session, SessionPlan, open_planned, plan_session

PATIENCE_S = 1800.0  # for a first start on a slow machine, or for another daemon's that fills the same cache [s]
_LOOK_S = 0.2  # how often the main thread can be interrupted [s]
_EARLY_TRACKER = "shirt"

_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True, eq=False)
class FirstSession:
    """`session` and the configuration that it is of. preparation: what still goes on beside it; over, where the session
    is the one that was asked for."""

    session: Session
    config: Config
    preparation: Preparation


def first_session(
    config: Config,
    outputs: OpenOutputs,
    notifier: Notifier,
    held: ExitStack,
    on_open: Callable[[], None] = lambda: None,
    on_progress: Callable[[str], None] = lambda _: None,
) -> FirstSession:
    """Open the outputs, say so, also to `on_open`, and then prepare what they will send from; `on_progress` hears
    where that stands. What is left to prepare then ends with `held`. Called by the main thread, while it is the only
    one. Raises what opening them or a session raises.

    A signal's exception leaves another thread at work: see `end_despite_work`.
    """

    def tell(text: str) -> None:
        notifier.status(text)
        on_progress(text)

    plan = plan_session(config)
    try:
        preparation = held.enter_context(preparing_apart(config))
        outputs.open()
        on_open()
        notifier.ready(
            "compiling the tracker, once on this machine"
            if preparation.is_needed
            else "preparing the tracker"
        )
        notifier.patience(PATIENCE_S)
        preparation.wait(tell)
        is_early = not preparation.is_over
        if is_early:
            config = replace(config, tracker=replace(config.tracker, name=_EARLY_TRACKER))
            plan = plan_session(config)
            _log.info(
                "the stream begins with the shirt; legs, head and other clothes follow when they are prepared"
            )
        tell("preparing the tracker")
        session = _opened(plan, is_early)
    except BaseException:
        notifier.stopping()
        raise
    notifier.as_usual()
    on_progress("")
    return FirstSession(session, config, preparation)


def _opened(plan: SessionPlan, is_early: bool) -> Session:
    pool = ThreadPoolExecutor(1, "first-session")
    try:
        opening = pool.submit(_open, plan, is_early)
        while wait((opening,), _LOOK_S).not_done:
            pass  # a signal may end it here
        session = opening.result()
    finally:
        pool.shutdown(wait=False)
    give_back()
    return session


def _open(plan: SessionPlan, is_early: bool) -> Session:
    with ProgressBars() as progress:
        return open_planned(plan, progress, is_early)
