"""What a user may set of the supervisor; its other numbers are in `params`."""

from dataclasses import dataclass

from mocapd.errors import ConfigError
from mocapd.trackers.supervisor.kinds import KINDS


@dataclass(frozen=True, slots=True)
class AutoSection:
    """Which trackers it may use; each has its own section too.

    trackers: those it chooses from: colour (the shirt) and flex (any clothes, two cameras); what cannot run is left out
    """

    trackers: tuple[str, ...] = tuple(KINDS)

    def __post_init__(self) -> None:
        unknown = [name for name in self.trackers if name not in KINDS]
        if unknown or not self.trackers:
            raise ConfigError(
                f"no tracker to choose is called {unknown[0]!r}"
                if unknown
                else "no tracker is given",
                "tracker.auto.trackers",
                f"some of: {', '.join(KINDS)}",
            )
