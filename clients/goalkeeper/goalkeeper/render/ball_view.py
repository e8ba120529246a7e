"""The ball with its shadow and the streak it draws behind it when it is fast."""

from collections import deque

import numpy as np
from panda3d.core import LQuaternionf, NodePath, TransparencyAttrib

from goalkeeper.core.flight import BALL_RADIUS_M
from goalkeeper.render import pictures
from goalkeeper.render.meshes import ball_mesh, node_of, quad
from goalkeeper.render.panda_space import to_panda
from goalkeeper.render.shading import Shadow
from goalkeeper.render.textures import texture_of
from mocapd.types import Floats

_BELOW_M = -1.0  # a ball down there is none
_TRAIL = 6
_FAST_MPS = 6.0


class BallView:
    """One ball."""

    def __init__(self, lit: NodePath, unlit: NodePath) -> None:
        self._ball = node_of("ball", ball_mesh(BALL_RADIUS_M))
        self._ball.setTexture(texture_of("ball", pictures.ball(), tiles=True, smooth=True))
        self._ball.reparentTo(lit)
        self._shadow = Shadow(unlit, 0.55)
        spot = texture_of("trail", pictures.spot(32, 1.2))
        self._trail = [_trail_card(unlit, spot, i) for i in range(_TRAIL)]
        self._places: deque[Floats] = deque(maxlen=2 * _TRAIL)

    def show(self, ball_m: Floats, dt_s: float) -> None:
        """At a place (3,) in the goal's frame; below the ground: nowhere. It rolls as it moves."""
        if ball_m[1] < _BELOW_M:
            self._places.clear()
            for node in (self._ball, *self._trail):
                node.hide()
            self._shadow.hide()
            return
        at = to_panda(ball_m)
        if self._places:
            self._roll(at - self._places[-1])
        self._places.append(at)
        self._ball.setPos(*at.tolist())
        self._ball.show()
        self._shadow.show(at, (1.25 * BALL_RADIUS_M, 1.25 * BALL_RADIUS_M))
        self._draw_trail(dt_s)

    def _roll(self, move: Floats) -> None:
        """About the axis across its way; half as fast as on the ground, which the eye can follow."""
        size = float(np.linalg.norm(move))
        if 1e-5 < size < 2.0:
            axis = np.array([-move[1], move[0], 0.0])
            axis /= max(float(np.linalg.norm(axis)), 1e-6)
            half = 0.25 * size / BALL_RADIUS_M
            turn = LQuaternionf(float(np.cos(half)), *(np.sin(half) * axis).tolist())
            self._ball.setQuat(self._ball.getQuat() * turn)

    def _draw_trail(self, dt_s: float) -> None:
        places = list(self._places)[::-1]
        fast = len(places) > 1 and np.linalg.norm(places[0] - places[1]) > _FAST_MPS * dt_s
        for i, card in enumerate(self._trail):
            if fast and i + 1 < len(places) and np.linalg.norm(places[i + 1] - places[0]) < 4.0:
                card.setPos(*(0.5 * (places[i] + places[i + 1])).tolist())
                card.show()
            else:
                card.hide()


def _trail_card(parent: NodePath, texture: object, number: int) -> NodePath:
    share = 1.0 - number / _TRAIL
    half_m = BALL_RADIUS_M * (0.5 + 0.45 * share)
    corners = half_m * np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
    card = node_of("trail", quad(corners, (1, 1), (1.0, 1.0, 1.0, 0.22 * share)))
    card.setTexture(texture)
    card.setBillboardPointEye()
    card.setTransparency(TransparencyAttrib.MAlpha)
    card.setDepthWrite(False)
    card.setBin("transparent", 8)
    card.reparentTo(parent)
    return card
