"""SIGTERM while games hang: frozen as in a debugger, or stuck in their callback."""

import time
from functools import partial

from tests.attacks.attacked import attacked
from tests.attacks.herd import herd
from tests.attacks.scenario import Found, Scenario

WITHIN_S = 2.0
FROZEN_S = 60.0
JUST_FROZEN_S = 4.0  # no longer than it takes until the daemon misses them
WANTED = f"exit 0 in < {WITHIN_S:g} s"


def sigterm(count: int, frozen_s: float, kind: str = "reads") -> Found:
    """SIGTERM this long after so many subscribers hang."""
    with attacked() as daemon, herd(daemon.port, count, kind) as games:
        if kind == "reads":
            games.freeze()
        time.sleep(frozen_s)
        code, took_s = daemon.end()
        traceback = "Traceback" in daemon.log.read_text()
    figure = f"exit {code} in {took_s:.2f} s" + (", with a traceback" if traceback else "")
    return Found(figure, code == 0 and took_s < WITHIN_S and not traceback)


SCENARIOS = {
    **{
        f"sigterm-{count}-frozen-{frozen_s:g}s": Scenario(WANTED, partial(sigterm, count, frozen_s))
        for count in (1, 5, 50)
        for frozen_s in (JUST_FROZEN_S, FROZEN_S)
    },
    **{
        f"sigterm-{count}-stuck": Scenario(WANTED, partial(sigterm, count, JUST_FROZEN_S, "stuck"))
        for count in (1, 50)
    },
}
