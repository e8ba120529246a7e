"""The furnished room as a list of boxes and balls for the ray caster."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from mocapd.sim.colour import linear_from_srgb
from mocapd.sim.scenario import Room, Scenario, SurfaceSpec, Thing
from mocapd.types import Floats, Ints

PATTERNS = {
    "plain": 0, "plaster": 1, "planks": 2, "checks": 3, "grass": 4, "bricks": 5, "poster": 6, "portrait": 7,
}  # fmt: skip
BOX, BALL = 0, 1
_BOOK_COLOURS = (
    (150, 40, 45), (196, 120, 40), (210, 190, 90), (70, 120, 60), (40, 90, 130), (60, 60, 110),
    (120, 60, 120), (180, 175, 160), (60, 50, 45), (190, 80, 100), (40, 130, 130), (90, 90, 95),
)  # fmt: skip


class Primitives(NamedTuple):
    """P boxes and balls: shapes (P,9): middle x y z [m], 1 / half extents [1/m], cosine and sine
    of the yaw, 1 for a ball; albedo (P,3) linear RGB, pattern (P,), glow (P,) in the light of
    lamp (P,) (-1: none), noise seed (P,).

    They come in G things: primitives first[g]..first[g+1] lie in the ball centre (G,3), radius
    (G,); a thing that does not `cast` (G,) 0/1 throws no shadow: lamps, and the convex shell.
    """

    shapes: Floats
    albedo: Floats
    pattern: Ints
    glow: Floats
    lamp: Ints
    seed: Ints
    first: Ints
    ball: Floats  # (G,4): centre x y z, radius
    casts: Ints


@dataclass(frozen=True, slots=True)
class _Piece:
    middle_m: tuple[float, float, float]
    size_m: tuple[float, float, float]
    yaw_rad: float
    srgb: tuple[int, int, int]
    pattern: str = "plain"
    kind: int = BOX
    glow: float = 0.0
    lamp: int = -1


def furnish(scenario: Scenario) -> Primitives:
    """All surfaces of the scenario's background."""
    lamps = [light.name for light in scenario.lights]
    things = [_shell(scenario.room)]
    for i, thing in enumerate(scenario.room.things):
        rng = np.random.default_rng([scenario.seed, 2, i])
        things.append(_build(thing, lamps.index(thing.lamp) if thing.lamp else -1, rng))
    return _arrays(things)


def backdrop() -> Primitives:
    """A grey paper sweep, for the pictures of the shirt in neutral light."""
    grey = (128, 128, 128)
    floor = _Piece((0.0, -0.05, 0.0), (12.0, 0.1, 12.0), 0.0, grey, "plaster")
    return _arrays([[floor, _Piece((0.0, 2.0, -1.6), (12.0, 5.0, 0.1), 0.0, grey, "plaster")]])


def _arrays(things: list[list[_Piece]]) -> Primitives:
    """The shell comes first and, being convex and around everything, casts no shadow."""
    pieces = [piece for thing in things for piece in thing]
    balls = []
    for thing in things:
        middle = np.array([p.middle_m for p in thing])
        centre = 0.5 * (middle.min(0) + middle.max(0))
        reach = np.linalg.norm(middle - centre, axis=1)
        reach += 0.5 * np.linalg.norm([p.size_m for p in thing], axis=1)
        balls.append([*centre, reach.max()])
    shapes = [
        [*p.middle_m, *(2.0 / np.array(p.size_m)), np.cos(p.yaw_rad), np.sin(p.yaw_rad), p.kind]
        for p in pieces
    ]
    return Primitives(
        shapes=np.array(shapes, dtype=float),
        albedo=np.array([linear_from_srgb(p.srgb) for p in pieces]),
        pattern=np.array([PATTERNS[p.pattern] for p in pieces]),
        glow=np.array([p.glow for p in pieces]),
        lamp=np.array([p.lamp for p in pieces]),
        seed=np.arange(len(pieces)) * 7919 + 13,
        first=np.cumsum([0] + [len(thing) for thing in things]),
        ball=np.array(balls),
        casts=np.array([0] + [int(all(p.glow == 0.0 for p in thing)) for thing in things[1:]]),
    )


def _shell(room: Room) -> list[_Piece]:
    """Floor, walls and ceiling as slabs just outside the room's inner space."""
    (w, h, d), (x, z), s = room.size_m, room.middle_m, 0.1

    def slab(
        middle: tuple[float, float, float], size: tuple[float, float, float], of: SurfaceSpec
    ) -> _Piece:
        return _Piece(middle, size, 0.0, of.srgb, of.pattern)

    out = [slab((x, -s / 2, z), (w + 2 * s, s, d + 2 * s), room.floor)]
    if not room.outdoors:
        for side in (-1.0, 1.0):
            out.append(slab((x + side * (w + s) / 2, h / 2, z), (s, h, d + 2 * s), room.walls))
            out.append(slab((x, h / 2, z + side * (d + s) / 2), (w + 2 * s, h, s), room.walls))
        out.append(slab((x, h + s / 2, z), (w + 2 * s, s, d + 2 * s), room.ceiling))
    return out


def _build(thing: Thing, lamp: int, rng: np.random.Generator) -> list[_Piece]:
    """The pieces of one thing, first as if it stood at the origin, unturned."""
    w, h, d = thing.size_m
    if thing.kind == "bookshelf":
        local = _bookshelf(thing, rng)
    elif thing.kind == "table":
        leg = 0.05
        local = [_Piece((0, h - 0.02, 0), (w, 0.04, d), 0.0, thing.srgb, thing.pattern)]
        local += [
            _Piece((i * (w - leg) / 2, (h - 0.04) / 2, k * (d - leg) / 2), (leg, h - 0.04, leg), 0.0, thing.srgb)
            for i in (-1, 1)
            for k in (-1, 1)
        ]  # fmt: skip
    elif thing.kind == "sofa":
        c = thing.srgb
        local = [
            _Piece((0, 0.2 * h + 0.05, 0.04 * d), (w, 0.4 * h, d * 0.92), 0.0, c, "plaster"),
            _Piece((0, 0.5 * h, -0.4 * d), (w, h, 0.2 * d), 0.0, c, "plaster"),
            _Piece((-0.46 * w, 0.35 * h, 0), (0.1 * w, 0.7 * h, d), 0.0, c, "plaster"),
            _Piece((0.46 * w, 0.35 * h, 0), (0.1 * w, 0.7 * h, d), 0.0, c, "plaster"),
            _Piece((0.25 * w, 0.62 * h, -0.18 * d), (0.22 * w, 0.3 * h, 0.1), 0.3, (190, 150, 60)),
        ]
    elif thing.kind == "tree":
        local = [
            _Piece((0, 0.2 * h, 0), (0.09 * w, 0.4 * h, 0.09 * d), 0.0, (84, 64, 48), "plaster")
        ]
        for _ in range(9):
            x, y, z = rng.uniform((-0.3, 0.42, -0.3), (0.3, 0.85, 0.3)) * (w, h, d)
            size = rng.uniform(0.35, 0.6) * np.array([w, 0.45 * h, d])
            local.append(_Piece((x, y, z), tuple(size), 0.0, thing.srgb, "grass", BALL))
    elif thing.kind in ("poster", "portrait"):
        local = [_Piece((0, h / 2, 0), (w, h, d), 0.0, thing.srgb, thing.kind)]
    else:
        kind = BALL if thing.kind == "ball" else BOX
        local = [
            _Piece((0, h / 2, 0), (w, h, d), 0.0, thing.srgb, thing.pattern, kind, thing.glow, lamp)
        ]
    return [_in_room(piece, thing) for piece in local]


def _in_room(piece: _Piece, thing: Thing) -> _Piece:
    yaw = np.radians(thing.yaw_deg)
    c, s = np.cos(yaw), np.sin(yaw)
    x, y, z = piece.middle_m
    bx, by, bz = thing.base_m
    middle = (float(bx + c * x + s * z), float(by + y), float(bz - s * x + c * z))
    return _Piece(
        middle, piece.size_m, piece.yaw_rad + float(yaw), piece.srgb, piece.pattern, piece.kind,
        piece.glow, piece.lamp,
    )  # fmt: skip


def _bookshelf(thing: Thing, rng: np.random.Generator) -> list[_Piece]:
    """Back, sides and boards of the given colour, filled with books of many colours."""
    w, h, d = thing.size_m
    board = 0.03
    out = [_Piece((0, h / 2, -d / 2 + 0.01), (w, h, 0.02), 0.0, thing.srgb)]
    out += [
        _Piece((i * (w - board) / 2, h / 2, 0), (board, h, d), 0.0, thing.srgb) for i in (-1, 1)
    ]
    shelves = max(2, round(h / 0.36))
    gap = (h - board) / shelves
    for k in range(shelves + 1):
        out.append(_Piece((0, board / 2 + k * gap, 0), (w, board, d), 0.0, thing.srgb))
    for k in range(shelves):
        x = -w / 2 + board
        while x < w / 2 - board - 0.07:
            width = rng.uniform(0.035, 0.075)
            tall = (gap - board) * rng.uniform(0.62, 0.95)
            deep = d * rng.uniform(0.6, 0.85)
            if rng.uniform() > 0.08:
                colour = _BOOK_COLOURS[rng.integers(len(_BOOK_COLOURS))]
                middle = (x + width / 2, board + k * gap + tall / 2, 0.5 * (d - deep) - 0.03)
                out.append(_Piece(middle, (width - 0.004, tall, deep), 0.0, colour))
            x += width
    return out
