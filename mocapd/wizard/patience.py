"""How long a step goes on without seeing what it wants, however slow the machine is."""

from dataclasses import dataclass

_LONGEST_LOOK_S = (
    0.25  # of a frame set counts at most so much: a slow machine is not the wearer's fault
)


@dataclass(slots=True)
class Patience:
    """Seconds that are left of looks in vain; those in which something was seen are not counted."""

    left_s: float

    def looked(self, took_s: float, *, seen: bool) -> None:
        """One frame set was waited for and looked at."""
        if not seen:
            self.left_s -= min(took_s, _LONGEST_LOOK_S)

    @property
    def ended(self) -> bool:
        return self.left_s <= 0.0
