"""Draws one keeper from behind and in first person, off-screen: `python -m tests.clients.goalkeeper.drawn FOLDER`.

A process of its own, as Panda3D wants to be opened once in each.
"""

import sys
from pathlib import Path

from panda3d.core import Filename

from goalkeeper.core.match import Match, MatchRules
from goalkeeper.core.pitch import TICK_HZ
from goalkeeper.render.cameras import View
from goalkeeper.render.game_view import GameView, Moving
from goalkeeper.render.hud_lines import HudText
from goalkeeper.render.stage import Renderer, StageParams, open_stage
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


def _draw(base: object, seen: GameView, match: Match, view: View, name: str) -> None:
    seen.update(match, Moving(0.0, 1.0, view), HudText())
    for _ in range(2):
        base.graphicsEngine.renderFrame()  # type: ignore[attr-defined]
    path = Path(sys.argv[1]) / f"{name}.png"
    base.win.saveScreenshot(Filename.fromOsSpecific(str(path)))  # type: ignore[attr-defined]


if __name__ == "__main__":
    main()
