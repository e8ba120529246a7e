"""A recording of `mocapd record`, as the daemon sent it: each frame when it was published, not when it was seen."""

from collections.abc import Generator
from pathlib import Path

from goalkeeper.streams.sighting import Sighting, StreamState, pose_of_frame
from mocapd.errors import InputError
from mocapd.outputs.mcap.recording_reader import RecordingReader
from mocapd.outputs.wire import SkeletonFrame

_LONGEST_GAP_S = (
    2.0  # between two frames: a longer one, and a clock that went back, is played as this
)
_MOST_LATENCY_S = 1.0


class RecordedStream:
    """One person's frames, from time 0 on."""

    def __init__(self, path: Path, person: int = 0) -> None:
        """Raises InputError for what is no recording, or has no frame of this person."""
        self._frames = _of_person(RecordingReader(path), person)
        first = next(self._frames, None)
        if first is None:
            raise InputError(
                f"has no frame of person {person}", str(path), "record while somebody is tracked"
            )
        self._next: tuple[float, SkeletonFrame] | None = (0.0, first)

    def poll(self, now_s: float) -> list[Sighting]:
        """What was published until now_s."""
        out: list[Sighting] = []
        while self._next is not None and self._next[0] <= now_s:
            published_s, frame = self._next
            latency_s = (frame.publish_monotonic_ns - frame.capture_monotonic_ns) * 1e-9
            captured_s = published_s - min(max(latency_s, 0.0), _MOST_LATENCY_S)
            out.append(Sighting(captured_s, pose_of_frame(frame)))
            self._next = self._following(published_s, frame)
        return out

    def _following(
        self, published_s: float, frame: SkeletonFrame
    ) -> tuple[float, SkeletonFrame] | None:
        later = next(self._frames, None)
        if later is None:
            return None
        gap_s = (later.publish_monotonic_ns - frame.publish_monotonic_ns) * 1e-9
        return published_s + min(max(gap_s, 0.0), _LONGEST_GAP_S), later

    def state(self) -> StreamState:
        """Ended with the last frame."""
        ended = self._next is None
        return StreamState("the recording has ended" if ended else "", ended)

    def close(self) -> None:
        """The file."""
        self._next = None
        self._frames.close()


def _of_person(reader: RecordingReader, person: int) -> Generator[SkeletonFrame, None, None]:
    """Raises InputError."""
    for item in reader.everything():
        if isinstance(item, SkeletonFrame) and item.person == person:
            yield item
