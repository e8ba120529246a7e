"""The timeout of a step for data that it cannot see, independent of the machine's speed."""

from dataclasses import dataclass

_LONGEST_LOOK_S = (
    0.25  # upper bound of the time of a frame set: a slow machine is not the wearer's fault
)


@dataclass(slots=True)
class VisibilityTimeout:
    """Remaining seconds of frame sets without visible data; others do not count."""

    left_s: float

    def update(self, took_s: float, *, visible: bool) -> None:
        """Count one frame set."""
        if not visible:
            self.left_s -= min(took_s, _LONGEST_LOOK_S)

    @property
    def is_over(self) -> bool:
        return self.left_s <= 0.0
