"""Games come while others are frozen."""

from functools import partial

from tests.attacks import newcomers
from tests.attacks.attacked import attacked
from tests.attacks.herd import herd
from tests.attacks.scenario import Found, Scenario

NEWCOMERS = 26  # one a second: until the daemon missed the frozen ones and gave up closing on them


def attack(count: int) -> Found:
    """Newcomers after so many subscribers froze."""
    with attacked() as daemon, herd(daemon.port, count) as games:
        games.freeze()
        return newcomers.found(newcomers.times_s(daemon.port, NEWCOMERS))


SCENARIOS = {
    f"newcomers-{count}-frozen": Scenario(
        f"all served in {newcomers.WITHIN_S:g} s", partial(attack, count)
    )
    for count in (1, 3, 5, 50)
}
