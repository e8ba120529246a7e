"""Free-running cameras as the bundler sees them: frames and arrivals from rates, phases and faults."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.pipeline.bundler import Bundler
from mocapd.types import Frame, FrameSet

MS = 1_000_000
PERIOD_NS = 33_333_333
PIXELS = np.zeros((2, 2, 3), np.uint8)


def frame(camera: str, seq: int, t_ns: int) -> Frame:
    """A frame whose picture does not matter."""
    return Frame(camera, seq, t_ns, PIXELS)


@dataclass(frozen=True)
class FreeRunning:
    """A camera: frame k is taken at phase + k periods + jitter and arrives `delay_ns` later."""

    name: str
    phase_ns: int = 0
    period_ns: int = PERIOD_NS
    jitter_ns: int = 0
    delay_ns: int = 20 * MS
    drop: float = 0.0
    dead: tuple[int, int] = (0, 0)  # no frame in between [ns]

    def arrivals(self, duration_ns: int, rng: np.random.Generator) -> list[tuple[int, Frame]]:
        """(arrival, frame) of everything delivered."""
        out = []
        for k in range((duration_ns - self.phase_ns) // self.period_ns):
            t_ns = self.phase_ns + k * self.period_ns
            t_ns += int(rng.uniform(-self.jitter_ns, self.jitter_ns))
            if rng.random() < self.drop or self.dead[0] <= t_ns < self.dead[1]:
                continue
            arrival_ns = t_ns + self.delay_ns + int(rng.uniform(0, self.jitter_ns))
            out.append((arrival_ns, frame(self.name, k, t_ns)))
        return out


@dataclass(frozen=True)
class Released:
    """A set, when it went out, and the last arrival of its own frames."""

    frames: FrameSet
    at_ns: int
    complete_ns: int


def run_live(
    bundler: Bundler, cameras: Sequence[FreeRunning], duration_ns: int, seed: int = 0
) -> list[Released]:
    """Feeds frames as they arrive and flushes at each deadline, as the pipeline's thread would."""
    rng = np.random.default_rng(seed)
    arrivals = sorted(
        (a for camera in cameras for a in camera.arrivals(duration_ns, rng)),
        key=lambda a: (a[0], a[1].camera),
    )
    arrived: dict[tuple[str, int], int] = {}
    out: list[Released] = []

    def release(sets: tuple[FrameSet, ...], at_ns: int) -> None:
        for s in sets:
            complete = max(arrived[f.camera, f.seq] for f in s.frames.values())
            out.append(Released(s, at_ns, complete))

    for now_ns, one in arrivals:
        while (deadline := bundler.deadline_ns) is not None and deadline < now_ns:
            release(bundler.flush(deadline), deadline)
        arrived[one.camera, one.seq] = now_ns
        release(bundler.add(one, now_ns), now_ns)
    release(bundler.finish(), duration_ns)
    return out
