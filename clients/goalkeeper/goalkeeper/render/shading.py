"""Light for what moves: floodlights from above and before, and the glow of the grass; and shadows on it."""

import numpy as np
from panda3d.core import AmbientLight, DirectionalLight, LVector3, NodePath, TransparencyAttrib

from goalkeeper.render import pictures
from goalkeeper.render.meshes import node_of, quad
from goalkeeper.render.textures import texture_of
from mocapd.types import Floats


def light(root: NodePath) -> None:
    """Light everything below this node, per vertex: the software renderer does no more."""
    for name, colour, way in (
        ("front", (0.62, 0.62, 0.58), (0.45, -0.55, -0.70)),
        ("back", (0.42, 0.44, 0.50), (-0.50, 0.60, -0.62)),
    ):
        lamp = DirectionalLight(name)
        lamp.setColor((*colour, 1.0))
        lamp.setDirection(LVector3(*way))
        root.setLight(root.attachNewNode(lamp))
    around = AmbientLight("around")
    around.setColor((0.36, 0.39, 0.40, 1.0))
    root.setLight(root.attachNewNode(around))


class Shadow:
    """A soft dark spot on the grass."""

    def __init__(self, parent: NodePath, darkness: float) -> None:
        corners = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
        self._node = node_of("shadow", quad(corners, (1, 1), (0.0, 0.02, 0.0, darkness)))
        self._node.setTexture(texture_of("shadow", pictures.spot(32, 1.0)))
        self._node.setTransparency(TransparencyAttrib.MAlpha)
        self._node.setBin("background", 5)
        self._node.setDepthWrite(False)
        self._node.setDepthTest(False)
        self._node.reparentTo(parent)

    def show(self, at: Floats, half_m: tuple[float, float]) -> None:
        """Below a point (3,) in Panda3D's axes; fainter the higher that is."""
        grown = 1.0 + 0.35 * max(float(at[2]), 0.0)
        self._node.setPos(float(at[0]), float(at[1]), 0.0)
        self._node.setScale(half_m[0] * grown, half_m[1] * grown, 1.0)
        self._node.setAlphaScale(1.0 / grown**1.5)
        self._node.show()

    def hide(self) -> None:
        """There is nothing above."""
        self._node.hide()
