"""What a player is made of: lofted limbs in a kit's colours, of an adult's girth."""

from dataclasses import dataclass, replace

import numpy as np

from goalkeeper.render.meshes import Mesh, Ring, ball_mesh, joined, loft

Colour = tuple[float, float, float]
_EYES = np.array([0.08, 0.07, 0.07, 1.0])


@dataclass(frozen=True, slots=True)
class Kit:
    """Colours of one player, 0..1."""

    shirt: Colour
    shorts: Colour
    socks: Colour
    gloves: Colour
    skin: Colour = (0.80, 0.60, 0.48)
    hair: Colour = (0.16, 0.10, 0.07)
    boots: Colour = (0.08, 0.08, 0.09)
    trim: Colour = (0.08, 0.09, 0.12)


KEEPER = Kit((0.98, 0.55, 0.08), (0.10, 0.11, 0.16), (0.98, 0.55, 0.08), (0.93, 0.96, 0.92))
STRIKER = Kit(
    (0.14, 0.36, 0.80),
    (0.92, 0.93, 0.95),
    (0.14, 0.36, 0.80),
    (0.62, 0.46, 0.37),
    hair=(0.05, 0.04, 0.04),
)


@dataclass(frozen=True, slots=True)
class BodyPiece:
    """A mesh of length 1 between two points of the body; its depth looks to the body's front."""

    name: str
    start: str
    end: str
    mesh: Mesh


def body_pieces(kit: Kit) -> list[BodyPiece]:
    """Everything, trunk first."""
    return [
        BodyPiece("trunk", "hips", "neck", _trunk(kit)),
        BodyPiece("head", "head", "crown", _head(kit)),
        BodyPiece("hair", "head", "crown", _hair(kit)),
        BodyPiece("eyes", "head", "crown", _eyes()),
        BodyPiece("throat", "neck", "head", _straight(0.058, 0.060, kit.skin)),
        *(piece for side in ("left", "right") for piece in _side(side, kit)),
    ]


def _side(side: str, kit: Kit) -> list[BodyPiece]:
    return [
        BodyPiece(f"{side} upper arm", f"{side}UpperArm", f"{side}LowerArm", _upper_arm(kit)),
        BodyPiece(f"{side} forearm", f"{side}LowerArm", f"{side}Hand", _forearm(kit)),
        BodyPiece(f"{side} glove", f"{side}Hand", f"{side}Tip", _glove(kit)),
        BodyPiece(f"{side} thigh", f"{side}UpperLeg", f"{side}LowerLeg", _thigh(kit)),
        BodyPiece(f"{side} shin", f"{side}LowerLeg", f"{side}Foot", _shin(kit)),
        BodyPiece(f"{side} boot", f"{side}Foot", f"{side}Toes", _boot(kit)),
    ]


def _trunk(kit: Kit) -> Mesh:
    s, d = kit.shirt, kit.shorts
    return loft(
        [
            Ring(-0.16, 0.02, 0.02, d), Ring(-0.15, 0.120, 0.095, d), Ring(0.02, 0.170, 0.118, d),
            Ring(0.10, 0.163, 0.114, d), Ring(0.10, 0.168, 0.118, kit.trim), Ring(0.13, 0.166, 0.117, kit.trim),
            Ring(0.13, 0.166, 0.117, s), Ring(0.38, 0.156, 0.108, s), Ring(0.66, 0.186, 0.122, s),
            Ring(0.82, 0.205, 0.112, s), Ring(0.91, 0.165, 0.092, s), Ring(0.97, 0.090, 0.075, s),
            Ring(0.97, 0.078, 0.072, kit.trim), Ring(1.01, 0.066, 0.064, kit.trim), Ring(1.03, 0.02, 0.02, kit.skin),
        ],
        sides=16,
    )  # fmt: skip


def _head(kit: Kit) -> Mesh:
    c = kit.skin
    return loft(
        [Ring(-0.75, 0.015, 0.02, c), Ring(-0.62, 0.055, 0.070, c), Ring(-0.25, 0.074, 0.092, c),
         Ring(0.30, 0.082, 0.103, c), Ring(0.85, 0.078, 0.100, c), Ring(1.20, 0.058, 0.076, c), Ring(1.38, 0.02, 0.02, c)],
        sides=14,
    )  # fmt: skip


def _hair(kit: Kit) -> Mesh:
    c = kit.hair
    return loft(
        [Ring(0.62, 0.03, 0.03, c), Ring(0.66, 0.084, 0.106, c), Ring(0.95, 0.086, 0.110, c), Ring(1.28, 0.066, 0.086, c),
         Ring(1.48, 0.02, 0.02, c)],
        sides=14,
    )  # fmt: skip


def _eyes() -> Mesh:
    """Two dark dots on the front of a head, whose length of about a tenth of a metre flattens them."""
    dot = ball_mesh(0.012, rows=6, columns=8)
    stretched = dot.vertices * [1.0, 1.0, 10.0]
    return joined(
        [
            replace(dot, vertices=stretched + [x, 0.098, 0.42], colours=dot.colours * _EYES)
            for x in (-0.032, 0.032)
        ]
    )


def _straight(from_m: float, to_m: float, colour: Colour) -> Mesh:
    return loft([Ring(-0.2, from_m, from_m, colour), Ring(1.1, to_m, to_m, colour)])


def _upper_arm(kit: Kit) -> Mesh:
    s = kit.shirt
    return loft(
        [Ring(-0.22, 0.01, 0.01, s), Ring(-0.14, 0.055, 0.052, s), Ring(0.05, 0.066, 0.064, s), Ring(0.5, 0.059, 0.058, s),
         Ring(1.0, 0.051, 0.051, s), Ring(1.08, 0.03, 0.03, s)]
    )  # fmt: skip


def _forearm(kit: Kit) -> Mesh:
    s, c = kit.shirt, kit.skin
    return loft(
        [Ring(-0.08, 0.02, 0.02, s), Ring(0.0, 0.049, 0.049, s), Ring(0.25, 0.053, 0.052, s), Ring(0.62, 0.044, 0.043, s),
         Ring(0.62, 0.046, 0.045, kit.trim), Ring(0.68, 0.045, 0.044, kit.trim), Ring(0.68, 0.037, 0.035, c),
         Ring(1.02, 0.030, 0.028, c)]
    )  # fmt: skip


def _glove(kit: Kit) -> Mesh:
    g, t = kit.gloves, kit.trim
    return loft(
        [Ring(-0.36, 0.02, 0.02, t), Ring(-0.34, 0.043, 0.038, t), Ring(0.0, 0.044, 0.036, t), Ring(0.0, 0.050, 0.036, g),
         Ring(0.35, 0.068, 0.034, g), Ring(0.80, 0.074, 0.031, g), Ring(1.20, 0.066, 0.027, g), Ring(1.45, 0.042, 0.021, g),
         Ring(1.52, 0.01, 0.01, g)]
    )  # fmt: skip


def _thigh(kit: Kit) -> Mesh:
    d, c = kit.shorts, kit.skin
    return loft(
        [Ring(-0.10, 0.03, 0.03, d), Ring(-0.04, 0.086, 0.088, d), Ring(0.15, 0.098, 0.100, d), Ring(0.55, 0.098, 0.098, d),
         Ring(0.55, 0.072, 0.074, c), Ring(0.9, 0.058, 0.060, c), Ring(1.05, 0.045, 0.045, c)]
    )  # fmt: skip


def _shin(kit: Kit) -> Mesh:
    k, c = kit.socks, kit.skin
    return loft(
        [Ring(-0.06, 0.03, 0.03, c), Ring(0.0, 0.054, 0.056, c), Ring(0.1, 0.053, 0.055, c), Ring(0.1, 0.057, 0.059, k),
         Ring(0.32, 0.061, 0.066, k), Ring(0.75, 0.043, 0.046, k), Ring(1.0, 0.041, 0.045, k), Ring(1.06, 0.02, 0.02, k)]
    )  # fmt: skip


def _boot(kit: Kit) -> Mesh:
    b = kit.boots
    return loft(
        [Ring(-0.50, 0.01, 0.01, b), Ring(-0.45, 0.035, 0.035, b), Ring(0.0, 0.043, 0.050, b), Ring(0.7, 0.050, 0.036, b),
         Ring(1.3, 0.043, 0.024, b), Ring(1.5, 0.01, 0.01, b)]
    )  # fmt: skip
