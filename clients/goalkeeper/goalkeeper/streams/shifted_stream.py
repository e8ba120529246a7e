"""A recording in the game's time: it begins when it is first asked."""

from goalkeeper.streams.sighting import PoseStream, Sighting, StreamState


class ShiftedStream:
    """Its times are those of the clock that `poll` is asked with."""

    def __init__(self, stream: PoseStream) -> None:
        self._stream = stream
        self._began_s: float | None = None

    def poll(self, now_s: float) -> list[Sighting]:
        """What is new."""
        if self._began_s is None:
            self._began_s = now_s
        began_s = self._began_s
        return [
            Sighting(one.captured_s + began_s, one.pose)
            for one in self._stream.poll(now_s - began_s)
        ]

    def state(self) -> StreamState:
        """That of the recording."""
        return self._stream.state()

    def close(self) -> None:
        """The recording."""
        self._stream.close()
