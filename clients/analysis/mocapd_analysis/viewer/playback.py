"""Where in the time of a session the viewer is. Pure: whoever draws says how much time went by."""

from dataclasses import dataclass

from mocapd_analysis.session import Session

RATES = ("1/16", "1/8", "1/4", "1/2", "1", "2")


@dataclass(slots=True)
class Playback:
    """start_s..end_s: what there is to see [s]; at_s: now; rate: seconds of the session in a second."""

    start_s: float
    end_s: float
    at_s: float
    rate: float = 1.0
    playing: bool = True
    loop: bool = True

    def advance(self, passed_s: float) -> None:
        """After so much time of the one who looks [s]; at the end it starts again, or stays there."""
        if not self.playing:
            return
        self.at_s += passed_s * self.rate
        if self.at_s < self.end_s:
            return
        length_s = self.end_s - self.start_s
        if self.loop and length_s > 0.0:
            self.at_s = self.start_s + (self.at_s - self.start_s) % length_s
        else:
            self.at_s, self.playing = self.end_s, False

    def seek(self, at_s: float) -> None:
        """To a time, or the nearest that there is."""
        self.at_s = min(max(at_s, self.start_s), self.end_s)

    def step(self, session: Session, frames: int) -> None:
        """Some frames of a session on, or back, and stop there."""
        self.playing = False
        times_s = session.times_s
        nearest = int(abs(times_s - self.at_s).argmin())
        self.seek(float(times_s[min(max(nearest + frames, 0), len(times_s) - 1)]))


def rate_of(words: str) -> float:
    """One of RATES as a number."""
    above, _, below = words.partition("/")
    return float(above) / float(below or 1.0)
