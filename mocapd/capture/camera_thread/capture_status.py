"""How one camera's capture thread fares."""

from dataclasses import dataclass
from enum import StrEnum

SILENT_S = 1.0  # from a live camera: so long without a frame is told [s]


class CaptureState(StrEnum):
    """`lost` is a state, not an error: the camera is sought again until it is back."""

    OPENING = "opening"
    LIVE = "live"
    LOST = "lost"
    ENDED = "ended"

    @property
    def told(self) -> str:
        """The word for it in messages to others."""
        return "starting" if self is CaptureState.OPENING else self.value


@dataclass(frozen=True, slots=True)
class CaptureStatus:
    """A snapshot of one capture thread.

    `reason`: why it is lost or ended, and the mend; empty while live. `notice`: what is wrong with its
    pictures or its place while it is live. `reopens`: how often it came
    back after a loss. `fps_hz` is measured from the frames' own times over the last 2 s; it falls by
    the clock while a read blocks. `last_frame_ns`: the newest frame's own time, None before the first.
    `silent_s`: since the newest frame came [s]; 0 unless live.
    """

    camera: str
    state: CaptureState
    reason: str
    frames: int
    torn: int
    reopens: int
    fps_hz: float
    last_frame_ns: int | None
    silent_s: float = 0.0
    notice: str = ""

    @property
    def is_silent(self) -> bool:
        """Whether it counts as live and yet sends nothing: its driver does not come back."""
        return self.state is CaptureState.LIVE and self.silent_s >= SILENT_S

    @property
    def trouble(self) -> str:
        """What is wrong with it, for people; empty when nothing is."""
        return f"silent for {self.silent_s:.0f} s" if self.is_silent else self.reason or self.notice
