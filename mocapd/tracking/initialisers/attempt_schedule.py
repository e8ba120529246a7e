"""When to search for a person: the machine has other work, too."""

from mocapd.clock import nanoseconds
from mocapd.tracking.cues.clothes.clothes_params import StartParams


class AttemptSchedule:
    """When to search. After a slow piece of a search, other work gets as much time as the piece took."""

    def __init__(self, params: StartParams) -> None:
        self._pause_ns = nanoseconds(params.pause_s)
        self._most_ns = nanoseconds(params.most_rest_s)
        self._next_ns = 0
        self._attempt_ns: int | None = None  # until the frame set after it has come

    def on_frame_set(self, t_ns: int) -> None:
        """Measures how long the last piece took, from the first frame set after it."""
        if self._attempt_ns is None:
            return
        took_ns, self._attempt_ns = t_ns - self._attempt_ns, None
        if took_ns > self._pause_ns:
            self._next_ns = t_ns + min(took_ns, self._most_ns)

    def is_due(self, t_ns: int) -> bool:
        """True if this frame set should start or continue a search."""
        return t_ns >= self._next_ns

    def on_attempt(self, t_ns: int, pauses: bool) -> None:
        """Records a piece done at this frame set. pauses: a pause follows, as after the last piece of a search."""
        self._attempt_ns = t_ns
        if pauses:
            self._next_ns = t_ns + self._pause_ns
