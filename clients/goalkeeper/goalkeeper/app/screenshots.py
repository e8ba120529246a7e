"""Draws the README's pictures: `python -m goalkeeper.app.screenshots FOLDER`.

The demo's person plays as she truly moves, in a time of its own: the same pictures each time.
"""

import sys
from argparse import ArgumentParser
from collections.abc import Callable
from pathlib import Path

from panda3d.core import Filename

from goalkeeper.app.fixed_steps import FixedSteps
from goalkeeper.app.high_scores import HighScore, with_round
from goalkeeper.app.hud_text import PlayerSettings, Popups, hud_text
from goalkeeper.app.options import window_size
from goalkeeper.core.events import Event, Saved
from goalkeeper.core.match import Match, MatchRules, Phase
from goalkeeper.core.pitch import TICK_S
from goalkeeper.render.cameras import View
from goalkeeper.render.game_view import GameView, Moving
from goalkeeper.render.stage import Renderer, Stage, StageParams, open_stage
from goalkeeper.streams.demo_script import demo_scenario
from goalkeeper.streams.person_stream import PersonStream
from goalkeeper.streams.scripted_shooter import ScriptedShooter
from goalkeeper.streams.sighting import StreamState
from mocapd.errors import CannotCreateError, MocapdError

_TICKS_A_PICTURE = 2
_DATE = "2026-01-01"
_FOOT = "60 Hz"
_EARLIER = (HighScore(2140, 12, 3, 7, _DATE, "Noor"), HighScore(960, 7, 6, 3, _DATE, "Kim"))
Wanted = Callable[[Match, list[Event]], bool]


class _Session:
    """A match that is drawn where it is looked at."""

    def __init__(self, stage: Stage, folder: Path) -> None:
        self._stage, self._folder = stage, folder
        self.match = Match(MatchRules(round_s=26.0), ScriptedShooter())
        self._steps = FixedSteps(self.match, PersonStream(demo_scenario()))
        self._seen = GameView(stage.base)
        self._popups = Popups()
        self._now_s = 0.0

    def until(self, wanted: Wanted, view: View, name: str, after: int = 0) -> None:
        """Play until something is so, and `after` pictures more, and keep a picture."""
        left: int | None = None
        while left is None or left > 0:
            events = [event for _ in range(_TICKS_A_PICTURE) for event in self._steps.tick()]
            self._now_s += _TICKS_A_PICTURE * TICK_S
            self._popups.heard(events, self._now_s)
            self._seen.heard(events, self._now_s)
            left = left - 1 if left is not None else (after if wanted(self.match, events) else None)
            # the trail and the camera need the pictures before
            self._update(view)
        self.shoot(view, name)

    def shoot(self, view: View, name: str) -> None:
        """Keep a picture of now."""
        self._update(view)
        self._stage.base.graphicsEngine.renderFrame()
        self._stage.base.graphicsEngine.renderFrame()
        path = self._folder / name
        if not self._stage.base.win.saveScreenshot(Filename.fromOsSpecific(str(path))):
            raise CannotCreateError("cannot be written", str(path), "choose another folder")
        print(path)

    def _update(self, view: View) -> None:
        placed = None
        if self.match.phase is Phase.OVER:
            placed = with_round(_EARLIER, self.match.score, _DATE, "Kim")
        popup = self._popups.text(self._now_s)
        text = hud_text(self.match, _FOOT, StreamState(), popup, placed, PlayerSettings(name="Kim"))
        dt_s = _TICKS_A_PICTURE * TICK_S
        self._seen.update(self.match, Moving(self._now_s, dt_s, view), text)


def _saved(_: Match, events: list[Event]) -> bool:
    return any(isinstance(event, Saved) for event in events)


def _coming(at_z_m: float, shot: int) -> Wanted:
    """The ball of that shot, or of a later one, is so near."""

    def is_near(match: Match, _: list[Event]) -> bool:
        ball = match.ball
        flying = ball is not None and ball.outcome is None and ball.shot.number >= shot
        return ball is not None and flying and float(ball.position_m[2]) < at_z_m

    return is_near


def main(arguments: list[str] | None = None) -> int:
    """The exit code."""
    parser = ArgumentParser("screenshots", description="draws the README's pictures")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--renderer", choices=("gl", "software"), default="software")
    parser.add_argument("--size", type=window_size, default=(960, 540), metavar="WxH")
    options = parser.parse_args(arguments)
    try:
        stage = open_stage(
            StageParams(options.size, Renderer(options.renderer), offscreen=True, sound=False)
        )
        options.folder.mkdir(parents=True, exist_ok=True)
        session = _Session(stage, options.folder)
        session.shoot(View.BEHIND, "start.png")
        session.until(lambda m, _: m.finder.progress > 0.6, View.BEHIND, "calibration.png")
        session.until(_coming(2.2, 1), View.BEHIND, "coming.png")
        session.until(_saved, View.BEHIND, "save.png", after=5)
        session.until(_coming(3.0, 3), View.FIRST, "first_person.png")
        session.until(
            lambda m, _: m.phase is Phase.REPLAY and m.replay_progress > 0.55,
            View.BEHIND,
            "replay.png",
        )
        session.until(lambda m, _: m.phase is Phase.OVER, View.BEHIND, "over.png", after=2)
    except MocapdError as error:
        print(f"screenshots: {error}", file=sys.stderr)
        return error.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
