"""The first session of a daemon, prepared when its outputs are open, beside the main thread, which a signal ends."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait

from mocapd.app.daemon.cache_warmup import preparing_apart
from mocapd.app.daemon.heap import give_back
from mocapd.app.daemon.notifier import Notifier
from mocapd.app.terminal.progress import ProgressBars
from mocapd.config.sections import Config
from mocapd.service.open_outputs import OpenOutputs
from mocapd.session.session import Session, SessionPlan, open_planned, plan_session

PATIENCE_S = 1800.0  # for a first start on a slow machine, or for another daemon's that fills the same cache [s]
_LOOK_S = 0.2  # how often the main thread can be interrupted [s]


def prepared_session(
    config: Config,
    outputs: OpenOutputs,
    notifier: Notifier,
    on_open: Callable[[], None] = lambda: None,
    on_progress: Callable[[str], None] = lambda _: None,
) -> Session:
    """Open the outputs, say so, also to `on_open`, and then prepare what they will send from; `on_progress` hears
    where that stands. Called by the main thread, while it is the only one. Raises what opening them or a session raises.

    A signal's exception leaves another thread at work: see `end_despite_work`.
    """

    def tell(text: str) -> None:
        notifier.status(text)
        on_progress(text)

    plan = plan_session(config)
    try:
        with preparing_apart(config) as preparation:
            outputs.open()
            on_open()
            notifier.ready(
                "compiling the tracker, once on this machine"
                if preparation.is_needed
                else "preparing the tracker"
            )
            notifier.patience(PATIENCE_S)
            preparation.wait(tell)
        tell("preparing the tracker")
        session = _opened(plan)
    except BaseException:
        notifier.stopping()
        raise
    notifier.as_usual()
    return session


def _opened(plan: SessionPlan) -> Session:
    pool = ThreadPoolExecutor(1, "first-session")
    try:
        opening = pool.submit(_open, plan)
        while wait((opening,), _LOOK_S).not_done:
            pass  # a signal may end it here
        session = opening.result()
    finally:
        pool.shutdown(wait=False)
    give_back()
    return session


def _open(plan: SessionPlan) -> Session:
    with ProgressBars() as progress:
        return open_planned(plan, progress)
