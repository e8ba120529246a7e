"""Judges in the step Cameras, where nothing is tracked yet, whether this machine is too busy to read its cameras."""

from mocapd.pipeline.other_programs import OtherPrograms
from mocapd.pipeline.slowness import OTHERS_SHARE, remedy

_BEGIN, _END = 0.9, 0.75  # busy share of all processors at which the verdict begins and ends


class MachineWatch:
    """load: read once a second at most. Used by one thread."""

    def __init__(self, load: OtherPrograms) -> None:
        self._load = load
        self._is_slow = False
        self._others = 0.0

    def tick(self, now_ns: int) -> None:
        """Read the load, if it is due."""
        self._others = self._load.share(now_ns)
        self._is_slow = self._load.busy > (_END if self._is_slow else _BEGIN)

    @property
    def slow(self) -> tuple[str, str] | None:
        """See Delivery; None for a machine with time to spare, and within the first second."""
        if not self._is_slow:
            return None
        if self._others >= OTHERS_SHARE:
            why = f"too slow, other programs use {100.0 * self._others:.0f} % of it"
        else:
            why = f"too slow, its processors are {100.0 * self._load.busy:.0f} % busy"
        return why, remedy(self._others)
