"""Everything that is seen, kept up with a match."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from goalkeeper.core.events import Conceded, Event, Kicked, Saved
from goalkeeper.core.limbs import LimbPose
from goalkeeper.core.match import Match, Phase
from goalkeeper.core.pitch import SHOT_FROM_Z_M
from goalkeeper.render.ball_view import BallView
from goalkeeper.render.body_meshes import KEEPER
from goalkeeper.render.body_view import BodyView
from goalkeeper.render.cameras import CameraMan, View, keeper_camera, replay_camera
from goalkeeper.render.goal_view import GoalView
from goalkeeper.render.hud import Hud
from goalkeeper.render.hud_lines import HudText
from goalkeeper.render.panda_space import to_panda
from goalkeeper.render.shading import Shadow, light
from goalkeeper.render.shooter_view import ShooterView
from goalkeeper.render.sparks import Sparks
from goalkeeper.render.stadium import StadiumView
from mocapd.types import Floats

_CHEER_S = 1.4
_NO_BALL: Floats = np.array([0.0, -10.0, 0.0])
_WAITS_AT_M: Floats = np.array([0.0, 0.105, SHOT_FROM_Z_M[0]])


@dataclass(frozen=True, slots=True)
class Moving:
    """now_s, dt_s: of this picture and since the last [s]; view: what the player chose."""

    now_s: float
    dt_s: float
    view: View


class GameView:
    """Built once on a stage; `update` before each picture."""

    def __init__(self, base: Any) -> None:
        base.setBackgroundColor(0.02, 0.03, 0.08)
        self._stadium = StadiumView(base.render)
        lit = base.render.attachNewNode("lit")
        light(lit)
        self._goal = GoalView(base.render)
        self._keeper_shadow = Shadow(base.render, 0.60)
        self._shooter_shadow = Shadow(base.render, 0.55)
        self._keeper = BodyView(lit, KEEPER)
        self._shooter = ShooterView(lit)
        self._ball = BallView(lit, base.render)
        self._sparks = Sparks(base.render)
        self._camera = CameraMan(base)
        self._hud = Hud(base)
        self._shot_from_m, self._run_up = _WAITS_AT_M, 0.0

    def heard(self, events: list[Event], now_s: float) -> None:
        """What happened since the last picture."""
        for event in events:
            if isinstance(event, Kicked):
                self._shot_from_m = event.shot.flight.at(0.0)
            elif isinstance(event, Saved):
                self._stadium.cheer(now_s, _CHEER_S)
                self._sparks.burst(event.outcome.place_m, now_s)
            elif isinstance(event, Conceded):
                self._goal.hit(now_s)

    def update(self, match: Match, moving: Moving, text: HudText) -> None:
        """Place everything for the next picture."""
        moment = match.moment()
        pose = None if moment is None else moment.pose
        self._show_keeper(pose, moving.view is View.FIRST and match.phase is not Phase.REPLAY)
        self._show_shooter(match)
        ball_m = _NO_BALL if moment is None else moment.ball_m
        if ball_m[1] < 0.0 and match.shot is not None and match.wind_up > 0.0:
            ball_m = match.shot.flight.at(0.0)
        self._ball.show(ball_m, moving.dt_s)
        self._stadium.update(moving.now_s)
        self._goal.update(moving.now_s)
        self._sparks.update(moving.now_s)
        if match.phase is Phase.REPLAY and pose is not None:
            self._camera.follow(replay_camera(pose, match.replay_progress), "replay", moving.dt_s)
        else:
            self._camera.follow(keeper_camera(moving.view, pose), moving.view, moving.dt_s)
        self._hud.show(text)

    def _show_keeper(self, pose: LimbPose | None, first_person: bool) -> None:
        if pose is None:
            self._keeper.root.hide()
            self._keeper_shadow.hide()
            return
        self._keeper.root.show()
        self._keeper.show(pose, first_person)
        middle = to_panda(pose.point("hips"))
        middle[2] = 0.0
        self._keeper_shadow.show(middle, (0.62, 0.42))

    def _show_shooter(self, match: Match) -> None:
        if match.shot is not None and match.wind_up > 0.0:
            self._shot_from_m, self._run_up = match.shot.flight.at(0.0), match.wind_up
        elif match.ball is not None:
            self._run_up = 1.0  # it stays where it kicked
        stands_m = self._shooter.show(self._shot_from_m, self._run_up)
        self._shooter_shadow.show(to_panda(stands_m), (0.5, 0.4))
