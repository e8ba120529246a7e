"""The status of one camera's capture thread."""

from dataclasses import dataclass, replace
from enum import StrEnum

SILENT_S = 1.0  # a live camera without a frame for so long is reported [s]


class CaptureState(StrEnum):
    """`lost` is a state, not an error: the thread tries to reopen the camera until it is back."""

    OPENING = "opening"
    LIVE = "live"
    LOST = "lost"
    ENDED = "ended"

    @property
    def wire_name(self) -> str:
        """The state's name in messages on the wire."""
        return "starting" if self is CaptureState.OPENING else self.value


@dataclass(frozen=True, slots=True)
class CaptureStatus:
    """A snapshot of one capture thread.

    `reason`: why it is lost or ended, and the fix; empty while live. `notice`: trouble with its pictures or its USB
    port while it is live. `reopens`: number of recoveries from a loss. `fps_hz`: rate by the frames' own times over
    the last 2 s; it falls with the clock while a read blocks. `last_frame_ns`: time of the newest frame, None
    before the first. `silent_s`: time since the newest frame arrived [s]; 0 unless live.
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
        """True if the camera is live but sends no frames: a call of its driver blocks."""
        return self.state is CaptureState.LIVE and self.silent_s >= SILENT_S

    @property
    def trouble(self) -> str:
        """The trouble in words, for users; empty without trouble."""
        return f"silent for {self.silent_s:.0f} s" if self.is_silent else self.reason or self.notice

    def counting_on(self, earlier: "CaptureStatus | None") -> "CaptureStatus":
        """With the counters of the same camera's earlier thread added."""
        if earlier is None:
            return self
        frames, torn = self.frames + earlier.frames, self.torn + earlier.torn
        return replace(self, frames=frames, torn=torn, reopens=self.reopens + earlier.reopens)
