"""Draws the pictures of a film of the game: `python -m goalkeeper.app.film FOLDER`.

`python -m lab.film OUT.webp --frames FOLDER` of a checkout joins them.

The demo's person plays as she truly moves, in a time of its own: the same film each time.
"""

import sys
from argparse import ArgumentParser
from pathlib import Path

from panda3d.core import Filename

from goalkeeper.app.fixed_steps import FixedSteps
from goalkeeper.app.hud_text import Popups, hud_text
from goalkeeper.core.match import Match, MatchRules, Phase
from goalkeeper.core.pitch import TICK_HZ, TICK_S
from goalkeeper.render.cameras import View
from goalkeeper.render.game_view import GameView, Moving
from goalkeeper.render.stage import Renderer, StageParams, open_stage
from goalkeeper.streams.demo_script import demo_scenario
from goalkeeper.streams.person_stream import PersonStream
from goalkeeper.streams.scripted_shooter import ScriptedShooter
from goalkeeper.streams.sighting import StreamState
from mocapd.errors import CannotCreateError, MocapdError

RATE_HZ = 10
LONGEST_S = 15.0
_SIZE_PX = (640, 360)


def draw(folder: Path, seconds: float) -> int:
    """From the T-pose on; how many pictures. Raises MocapdError."""
    stage = open_stage(StageParams(_SIZE_PX, Renderer.SOFTWARE, offscreen=True, sound=False))
    folder.mkdir(parents=True, exist_ok=True)
    match = Match(MatchRules(round_s=120.0, replay=False), ScriptedShooter())
    steps = FixedSteps(match, PersonStream(demo_scenario()))
    seen, popups = GameView(stage.base), Popups()
    made = 0
    for tick in range(round((seconds + 30.0) * TICK_HZ)):
        events = steps.tick()
        now_s = tick * TICK_S
        popups.heard(events, now_s)
        seen.heard(events, now_s)
        if tick % (TICK_HZ // RATE_HZ):
            continue
        text = hud_text(match, f"{RATE_HZ} Hz", StreamState(), popups.text(now_s), None)
        seen.update(match, Moving(now_s, 1.0 / RATE_HZ, View.BEHIND), text)
        if match.phase is Phase.CALIBRATING and not match.finder.progress:
            continue  # she still walks up
        for _ in range(2):
            stage.base.graphicsEngine.renderFrame()
        path = folder / f"{made:04d}.png"
        if not stage.base.win.saveScreenshot(Filename.fromOsSpecific(str(path))):
            raise CannotCreateError("cannot be written", str(path), "choose another folder")
        made += 1
        if made >= seconds * RATE_HZ:
            break
    return made


def main(arguments: list[str] | None = None) -> int:
    """The exit code."""
    parser = ArgumentParser("film", description="draws the pictures of a film of the game")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seconds", type=float, default=LONGEST_S)
    options = parser.parse_args(arguments)
    try:
        print(f"{draw(options.folder, options.seconds)} pictures")
    except MocapdError as error:
        print(f"film: {error}", file=sys.stderr)
        return error.exit_code
    return 0


if __name__ == "__main__":
    sys.exit(main())
