"""A burst where a ball is stopped."""

import numpy as np
from panda3d.core import NodePath, TransparencyAttrib

from goalkeeper.render import pictures
from goalkeeper.render.meshes import node_of, quad
from goalkeeper.render.panda_space import to_panda
from goalkeeper.render.textures import texture_of
from mocapd.types import Floats

_COUNT = 14
_LASTS_S = 0.45
_COLOUR = (1.0, 0.90, 0.45)


class Sparks:
    """One burst at a time; its directions are the same each time."""

    def __init__(self, parent: NodePath) -> None:
        rng = np.random.default_rng(3)
        ways = rng.normal(size=(_COUNT, 3))
        self._ways = (
            ways / np.linalg.norm(ways, axis=1, keepdims=True) * rng.uniform(0.6, 2.2, (_COUNT, 1))
        )
        texture = texture_of("spark", pictures.spot(16, 1.0))
        corners = 0.05 * np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
        self._cards = []
        for _ in range(_COUNT):
            card = node_of("spark", quad(corners, (1, 1), _COLOUR))
            card.setTexture(texture)
            card.setBillboardPointEye()
            card.setTransparency(TransparencyAttrib.MAlpha)
            card.setDepthWrite(False)
            card.setBin("transparent", 9)
            card.reparentTo(parent)
            card.hide()
            self._cards.append(card)
        self._at = np.zeros(3)
        self._began_s: float | None = None

    def burst(self, place_m: Floats, now_s: float) -> None:
        """At a place (3,) in the goal's frame."""
        self._at, self._began_s = to_panda(place_m), now_s

    def update(self, now_s: float) -> None:
        """Once a picture."""
        if self._began_s is None:
            return
        since_s = now_s - self._began_s
        if since_s > _LASTS_S:
            self._began_s = None
        left = max(1.0 - since_s / _LASTS_S, 0.0)
        for card, way in zip(self._cards, self._ways, strict=True):
            card.setPos(*(self._at + since_s * way).tolist())
            card.setScale(0.3 + left)
            card.setAlphaScale(left)
            if left > 0.0:
                card.show()
            else:
                card.hide()
