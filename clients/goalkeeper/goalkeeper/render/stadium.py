"""The ground: grass and lines, stands with people, boards, floodlights, dusk. Nothing here moves but the crowd.

All light is in the colours of the vertices and in the textures, so that it costs the software renderer nothing.
"""

from itertools import pairwise

import numpy as np
from panda3d.core import ColorBlendAttrib, NodePath, TextNode, TransparencyAttrib

from goalkeeper.core.pitch import GOAL_LINE_Z_M, GOAL_WIDTH_M
from goalkeeper.render import pictures
from goalkeeper.render.meshes import Mesh, box, joined, node_of, quad
from goalkeeper.render.textures import texture_of
from mocapd.types import Floats

GRASS_TILE_M = 4.0
SIDE_M, BACK_M, FAR_M = 15.0, -9.0, 26.0  # where the boards stand, in Panda3D's x and y
_WHITE = (0.93, 0.95, 0.93)
_BOARDS = ("MOCAPD", "GOALKEEPER", "COLOUR SHIRT", "SIXTY HERTZ", "TWO WEBCAMS", "NO MARKERS")
_BOARD_COLOURS = ((0.07, 0.09, 0.16), (0.85, 0.42, 0.06), (0.05, 0.28, 0.52), (0.55, 0.06, 0.10))
_CHEER_HZ = 5.0


class StadiumView:
    """Built once; `cheer` makes the people jump."""

    def __init__(self, parent: NodePath) -> None:
        self.root = parent.attachNewNode("stadium")
        self._cheer_until_s = 0.0
        _ground(self.root)
        self._crowds = _stands(self.root)
        self._pictures = [texture_of(f"crowd {i}", pictures.crowd(i), tiles=True) for i in range(2)]
        self._shown = -1
        _boards(self.root)
        _floodlights(self.root)
        self.root.flattenStrong()
        self.update(0.0)

    def cheer(self, now_s: float, seconds: float) -> None:
        """For so long."""
        self._cheer_until_s = now_s + seconds

    def update(self, now_s: float) -> None:
        """Once a picture."""
        shown = int(now_s * _CHEER_HZ) % 2 if now_s < self._cheer_until_s else 0
        if shown != self._shown:
            self._shown = shown
            for crowd in self._crowds:
                crowd.setTexture(self._pictures[shown], 1)


def _background(node: NodePath, order: int) -> None:
    """Drawn before everything that has a depth, in this order."""
    node.setBin("background", order)
    node.setDepthWrite(False)
    node.setDepthTest(False)


def _ground(root: NodePath) -> None:
    sky = node_of("sky", _sky())
    sky.setTexture(texture_of("sky", pictures.sky()))
    sky.reparentTo(root)
    _background(sky, 0)
    grass = node_of("grass", _grass())
    grass.setTexture(texture_of("grass", pictures.grass(), tiles=True, smooth=True))
    grass.reparentTo(root)
    _background(grass, 1)
    lines = node_of("lines", _lines())
    lines.reparentTo(root)
    _background(lines, 2)


def _sky(radius_m: float = 120.0, height_m: float = 75.0, sides: int = 12) -> Mesh:
    angles = 2 * np.pi * np.arange(sides + 1) / sides
    edge = radius_m * np.stack([np.sin(angles), np.cos(angles), 0 * angles], axis=-1)
    up = np.array([0.0, 0.0, height_m])
    low = np.array([0.0, 0.0, -6.0])
    walls = [
        quad(np.array([a + low, b + low, b + up, a + up]), (1, 1), (1.0, 1.0, 1.0))
        for a, b in pairwise(edge)
    ]
    return joined(walls)


def _grass(step_m: float = 4.0) -> Mesh:
    """A grid whose vertices are lit by the floodlights: bright in the middle, darker outwards."""
    x = np.arange(-SIDE_M - 8.0, SIDE_M + 8.1, step_m)
    y = np.arange(BACK_M - 8.0, FAR_M + 8.1, step_m)
    faces = []
    for x0 in x[:-1]:
        for y0 in y[:-1]:
            corners = np.array(
                [
                    [x0, y0, 0],
                    [x0 + step_m, y0, 0],
                    [x0 + step_m, y0 + step_m, 0],
                    [x0, y0 + step_m, 0],
                ]
            )
            face = quad(corners, (step_m / GRASS_TILE_M, step_m / GRASS_TILE_M), _WHITE)
            light = 1.25 - 0.018 * np.hypot(corners[:, 0], 0.8 * (corners[:, 1] - 7.0))
            face.colours[:, :3] = np.clip(light, 0.35, 1.0)[:, None]
            faces.append(face)
    return joined(faces)


def _lines(width_m: float = 0.10) -> Mesh:
    goal_y = GOAL_LINE_Z_M
    strips = [
        _strip((-SIDE_M + 1, goal_y), (SIDE_M - 1, goal_y), width_m),
        _strip((-0.15, goal_y + 6.0), (0.15, goal_y + 6.0), 0.2),
        _strip((-SIDE_M + 1, 22.0), (SIDE_M - 1, 22.0), width_m),
    ]
    strips += [
        _strip((s * (SIDE_M - 1), goal_y), (s * (SIDE_M - 1), 24.0), width_m) for s in (-1, 1)
    ]
    # the area of futsal: quarter circles of 6 m about the posts
    half = GOAL_WIDTH_M / 2
    turn = np.linspace(0.0, np.pi / 2, 13)
    for side in (-1, 1):
        arc = [(side * (half + 6.0 * np.cos(a)), goal_y + 6.0 * np.sin(a)) for a in turn]
        strips += [_strip(a, b, width_m) for a, b in pairwise(arc)]
    strips.append(_strip((-half, goal_y + 6.0), (half, goal_y + 6.0), width_m))
    turn = np.linspace(0.0, -np.pi, 17)
    arc = [(3.0 * np.cos(a), 22.0 + 3.0 * np.sin(a)) for a in turn]
    strips += [_strip(a, b, width_m) for a, b in pairwise(arc)]
    return joined(strips)


def _strip(a: tuple[float, float], b: tuple[float, float], width_m: float) -> Mesh:
    along = np.array(b) - np.array(a)
    aside = 0.5 * width_m * np.array([-along[1], along[0]]) / np.linalg.norm(along)
    flat = np.array([a - aside, b - aside, b + aside, a + aside])
    return quad(np.column_stack([flat, np.zeros(4)]), (1, 1), _WHITE)


def _stands(root: NodePath) -> list[NodePath]:
    """Three slopes of people, and what is above and below them."""
    crowds = []
    for name, a, b, out in _sides():
        base = np.array([[*a, 1.3], [*b, 1.3], [*(b + 9.0 * out), 7.2], [*(a + 9.0 * out), 7.2]])
        length_m = float(np.linalg.norm(b - a))
        slope = quad(base, (length_m / 14.0, 1.6), (1.0, 1.0, 1.0))
        slope.colours[2:, :3] = 0.55  # farther from the lights
        crowd = node_of(name, slope)
        crowd.reparentTo(root)
        crowd.setTag("crowd", name)
        crowds.append(crowd)
        walls = [
            _wall(a, b, (0.0, 1.3), (0.10, 0.11, 0.14)),
            _wall(a + 9.0 * out, b + 9.0 * out, (7.2, 9.6), (0.05, 0.055, 0.08)),
            _wall(a + 2.5 * out, b + 2.5 * out, (10.15, 10.5), (0.75, 0.78, 0.86)),
        ]
        front_a, front_b, back_a, back_b = (p + k * out for k in (2.5, 9.0) for p in (a, b))
        corners = [[*back_a, 9.6], [*back_b, 9.6], [*front_b, 10.4], [*front_a, 10.4]]
        roof = quad(np.array(corners), (1, 1), (0.085, 0.09, 0.115))
        shell = node_of(f"{name} shell", joined([*walls, roof]))
        shell.setTwoSided(True)
        shell.reparentTo(root)
    for crowd in crowds:
        crowd.setTwoSided(True)
    return crowds


def _wall(
    a: Floats, b: Floats, up_m: tuple[float, float], colour: tuple[float, float, float]
) -> Mesh:
    low, high = up_m
    return quad(np.array([[*a, low], [*b, low], [*b, high], [*a, high]]), (1, 1), colour)


def _sides() -> list[tuple[str, Floats, Floats, Floats]]:
    """Name, its two ends on the ground left to right as the field sees them, and which way is outwards; x, y."""
    s, f, n = SIDE_M + 1.2, FAR_M + 1.2, BACK_M - 1.2
    return [
        ("far", np.array([-s, f]), np.array([s, f]), np.array([0.0, 1.0])),
        ("right", np.array([s, f]), np.array([s, n]), np.array([1.0, 0.0])),
        ("left", np.array([-s, n]), np.array([-s, f]), np.array([-1.0, 0.0])),
        ("near", np.array([s, n]), np.array([-s, n]), np.array([0.0, -1.0])),
    ]


def _boards(root: NodePath) -> None:
    number = 0
    for _, a, b, out in _sides():
        along = (b - a) / np.linalg.norm(b - a)
        a, b = a - 1.0 * out, b - 1.0 * out
        count = max(3, round(float(np.linalg.norm(b - a)) / 6.5))
        for i in range(count):
            left, right = a + (b - a) * (i + 0.02) / count, a + (b - a) * (i + 0.98) / count
            colour = _BOARD_COLOURS[number % len(_BOARD_COLOURS)]
            panel = quad(
                np.array([[*left, 0.0], [*right, 0.0], [*right, 0.95], [*left, 0.95]]),
                (1, 1),
                colour,
            )
            node = node_of("board", panel)
            node.setTwoSided(True)
            node.reparentTo(root)
            middle = 0.5 * (left + right) - 0.03 * out
            _write(root, _BOARDS[number % len(_BOARDS)], (*middle, 0.30), along)
            number += 1


def _write(root: NodePath, words: str, at: tuple[float, ...], along: Floats) -> None:
    text = TextNode("board text")
    text.setText(words)
    text.setAlign(TextNode.ACenter)
    text.setTextColor(0.95, 0.96, 0.98, 1.0)
    node = root.attachNewNode(text.generate())
    node.setPos(*at)
    node.setH(float(np.degrees(np.arctan2(along[1], along[0]))))
    node.setScale(0.62)
    node.setTwoSided(True)


def _floodlights(root: NodePath) -> None:
    """Four masts with lamps that glow."""
    glow = texture_of("glow", pictures.spot(64, 2.2))
    for x in (-SIDE_M - 8.5, SIDE_M + 8.5):
        for y in (2.0, FAR_M + 7.5):
            mast = box(np.array([x, y, 8.0]), np.array([0.5, 0.5, 16.0]), (0.20, 0.21, 0.25))
            head = box(np.array([x, y, 16.6]), np.array([4.4, 0.6, 2.4]), (0.16, 0.17, 0.20))
            lamps = [
                box(np.array([x + dx, y - 0.35, 16.6 + dz]), np.array([0.8, 0.1, 0.62]), (1.7, 1.7, 1.6))
                for dx in (-1.6, -0.53, 0.53, 1.6) for dz in (-0.75, 0.0, 0.75)
            ]  # fmt: skip
            node_of("mast", joined([mast, head, *lamps])).reparentTo(root)
            card = node_of("glow", quad(_card(7.0), (1, 1), (0.75, 0.80, 0.95)))
            card.setTexture(glow)
            card.setPos(x, y - 0.6, 16.6)
            card.setBillboardPointEye()
            card.setTransparency(TransparencyAttrib.MAlpha)
            card.setAttrib(
                ColorBlendAttrib.make(
                    ColorBlendAttrib.MAdd, ColorBlendAttrib.OIncomingAlpha, ColorBlendAttrib.OOne
                )
            )
            card.setDepthWrite(False)
            card.setBin("fixed", 10)
            card.reparentTo(root)


def _card(half_m: float) -> Floats:
    return half_m * np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])
