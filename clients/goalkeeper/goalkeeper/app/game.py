"""The game with a picture: one `frame` after another, each as late as the clock says."""

import datetime
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

from goalkeeper.app.fixed_steps import FixedSteps
from goalkeeper.app.high_scores import Placed, keep_name, keep_round
from goalkeeper.app.hud_text import (
    MOST_NAME,
    PlayerSettings,
    Popups,
    hud_text,
    level_of,
    next_difficulty,
)
from goalkeeper.app.latency import Latency
from goalkeeper.core.events import RoundOver
from goalkeeper.core.match import Match, Phase
from goalkeeper.render.cameras import View
from goalkeeper.render.game_view import GameView, Moving
from goalkeeper.render.stage import Stage
from goalkeeper.sound.loudspeaker import Loudspeaker
from goalkeeper.streams.sighting import PoseStream

_RATE_OVER = 30  # pictures


@dataclass(frozen=True, slots=True)
class GameParts:
    """What a game is made of; sound: None for silence; scores: where the high scores are kept."""

    stage: Stage
    match: Match
    stream: PoseStream
    sound: Loudspeaker | None
    scores: Path
    settings: PlayerSettings = field(default_factory=PlayerSettings)


class Game:
    """Used by one thread."""

    def __init__(self, parts: GameParts, view: View) -> None:
        self.view, self.match = view, parts.match
        self._parts = parts
        self._steps = FixedSteps(parts.match, parts.stream)
        self._seen = GameView(parts.stage.base)
        self._popups, self._latency = Popups(), Latency()
        self.settings = parts.settings
        self._set_volume()
        self._placed: Placed | None = None
        self._last_s = time.monotonic()
        self._steps.begin(self._last_s)
        self._rate_hz, self._frames, self._rated_s = 0.0, 0, self._last_s

    @property
    def latency_s(self) -> float | None:
        """From camera to screen, lately."""
        return self._latency.median_s

    @property
    def waits(self) -> bool:
        """Whether no pose came yet: the processor is for who makes them."""
        return self._steps.newest_s is None

    @property
    def stream_ended(self) -> bool:
        """Whether no pose comes any more."""
        return self._parts.stream.state().ended

    def frame(self) -> None:
        """Run the match up to now, and draw it."""
        now_s = time.monotonic()
        events = self._steps.run_to(now_s)
        self._popups.heard(events, now_s)
        self._seen.heard(events, now_s)
        if self._parts.sound is not None:
            self._parts.sound.heard(events)
        if any(isinstance(event, RoundOver) for event in events):
            today = datetime.date.today().isoformat()
            name = self.settings.name
            self._placed = keep_round(self._parts.scores, self.match.score, today, name)
        state = self._parts.stream.state()
        text = hud_text(
            self.match,
            self._foot(now_s),
            state,
            self._popups.text(now_s),
            self._placed,
            self.settings,
        )
        self._seen.update(self.match, Moving(now_s, now_s - self._last_s, self.view), text)
        self._last_s = now_s
        self._parts.stage.base.taskMgr.step()
        self._latency.shown(self._steps.newest_s, time.monotonic())

    def switch_view(self) -> None:
        """From behind the goal to the keeper's eyes, and back."""
        self.view = View.FIRST if self.view is View.BEHIND else View.BEHIND

    def harder(self) -> None:
        """The next difficulty, from the next shot on."""
        difficulty = next_difficulty(self.settings.difficulty)
        self.settings = replace(self.settings, difficulty=difficulty)
        self.match.set_level(level_of(difficulty))

    def louder(self, by: float) -> None:
        """By that share of all."""
        volume = min(1.0, max(0.0, round(self.settings.volume + by, 2)))
        self.settings = replace(self.settings, volume=volume)
        self._set_volume()

    def type_name(self) -> None:
        """Keys are a name from now on, until Return; at the end of a round that is in the table."""
        is_placed = self._placed is not None and self._placed.place is not None
        if self.match.phase is Phase.OVER and is_placed:
            self.settings = replace(self.settings, types=True, name="")

    def typed(self, key: str) -> None:
        """One character, or `enter` or `backspace`."""
        settings = self.settings
        if key == "enter":
            self.settings = replace(settings, types=False)
            if self._placed is not None:
                self._placed = keep_name(self._parts.scores, self._placed, settings.name)
        elif key == "backspace":
            self.settings = replace(settings, name=settings.name[:-1])
        elif len(key) == 1 and key.isprintable() and len(settings.name) < MOST_NAME:
            self.settings = replace(settings, name=settings.name + key)

    def _set_volume(self) -> None:
        if self._parts.sound is not None:
            self._parts.sound.set_volume(self.settings.volume)

    def _foot(self, now_s: float) -> str:
        self._frames += 1
        if self._frames == _RATE_OVER:
            self._rate_hz = _RATE_OVER / max(now_s - self._rated_s, 1e-3)
            self._frames, self._rated_s = 0, now_s
        latency_s = self._latency.median_s
        late = "" if latency_s is None else f"camera to screen {1000 * latency_s:.0f} ms   "
        return f"{late}{self._rate_hz:.0f} Hz"
