"""Draws one keeper from behind and in first person, off-screen: `python -m tests.clients.goalkeeper.drawn FOLDER`; where
all texts lie in windows of several shapes is in texts.json.

A process of its own, as Panda3D wants to be opened once in each.
"""

import json
import sys
from dataclasses import replace
from pathlib import Path

from panda3d.core import Filename

from goalkeeper.app.hud_text import hud_text
from goalkeeper.core.match import Match, MatchRules
from goalkeeper.core.pitch import TICK_HZ
from goalkeeper.render.cameras import View
from goalkeeper.render.game_view import GameView, Moving
from goalkeeper.render.hud_lines import HudText
from goalkeeper.render.stage import Renderer, StageParams, open_stage
from goalkeeper.streams.sighting import StreamState
from tests.clients.goalkeeper.poses import left_hand_up
from tests.clients.goalkeeper.test_match import AT_HAND, AimedShooter, t_pose

SIZE_PX = (480, 270)


def main() -> None:
    """behind.png, first.png and empty.png: the stadium without anybody."""
    stage = open_stage(StageParams(SIZE_PX, Renderer.SOFTWARE, offscreen=True, sound=False))
    seen = GameView(stage.base)
    match = Match(MatchRules(), AimedShooter(AT_HAND))
    _draw(stage.base, seen, match, View.BEHIND, "empty")
    for _ in range(TICK_HZ):
        match.tick(t_pose())
    match.tick(left_hand_up())
    _draw(stage.base, seen, match, View.BEHIND, "behind")
    _draw(stage.base, seen, match, View.FIRST, "first")
    Path(sys.argv[1], "texts.json").write_text(json.dumps(_texts(stage.base, seen)))


def _texts(base: object, seen: GameView) -> dict[str, dict[str, list[float]]]:
    """By shape and text: its left, right, lower and upper end in a window of -1..1."""
    shapes = {"wide": 1280 / 657, "old": 4 / 3, "phone": 390 / 844}
    lost = StreamState(
        "no mocapd at tcp/127.0.0.1:7447 -- start `mocapd run` there, or name another one"
    )
    match = Match(MatchRules(), AimedShooter(AT_HAND))
    text = hud_text(match, "60 Hz   48 ms", lost, "SAVED  +122   12 in a row", None)
    text = replace(text, message=f"{lost.trouble}: {lost.trouble}")
    found = {}
    for shape, aspect in shapes.items():
        base.getAspectRatio = lambda aspect=aspect: aspect  # type: ignore[attr-defined]
        seen.update(match, Moving(0.0, 1.0, View.BEHIND), text)
        ends = {
            line.getName(): line.getTightBounds(base.render2d)  # type: ignore[attr-defined]
            for line in base.render2d.findAllMatches("**/+TextNode")  # type: ignore[attr-defined]
            if line.node().getText()
        }
        found[shape] = {
            name: [low[0], high[0], low[2], high[2]] for name, (low, high) in ends.items()
        }
    return found


def _draw(base: object, seen: GameView, match: Match, view: View, name: str) -> None:
    seen.update(match, Moving(0.0, 1.0, view), HudText())
    for _ in range(2):
        base.graphicsEngine.renderFrame()  # type: ignore[attr-defined]
    path = Path(sys.argv[1]) / f"{name}.png"
    base.win.saveScreenshot(Filename.fromOsSpecific(str(path)))  # type: ignore[attr-defined]


if __name__ == "__main__":
    main()
