"""Everybody in a picture as one mesh."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.sim.person.dress_kernels import REACH, Dress, covered
from mocapd.sim.person.dressing import joined_dresses
from mocapd.sim.person.figure import Figure, posed_figure
from mocapd.sim.person_spec import Screen
from mocapd.types import Bytes, Floats, Pose

_DEEP = 0.02  # share of a body's depth that remains, so that its surface keeps its order
_BEFORE_M = 0.02  # distance in front of the wall or stand


def on_screen(points_m: Floats, screen: Screen) -> Floats:
    """A person on a television in the room, flat and scaled to the screen: screen positions (N,3) [m, world] of points (N,3)
    of a scene centred on its floor."""
    yaw = np.radians(screen.yaw_deg)
    right = np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
    ahead = np.array([np.sin(yaw), 0.0, np.cos(yaw)])
    scale = screen.height_m / screen.shows_m
    x, y, z = scale * points_m.T
    flat = x[:, None] * right + y[:, None] * np.array([0.0, 1.0, 0.0])
    before = (_DEEP * z + _BEFORE_M)[:, None] * ahead
    out: Floats = np.array(screen.base_m) + flat + before
    return out


@dataclass(frozen=True, slots=True, eq=False)
class PersonBody:
    """One person at one instant. jacket: how far it is on, 0..1; screen: that shows the person, if any."""

    pose: Pose
    jacket: float = 0.0
    screen: Screen | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Group:
    """figures, one after the other in triangles (T,3), albedo (T,3) and dress; vertices: how many the first has."""

    figures: tuple[Figure, ...]
    triangles: NDArray[np.int32]
    albedo: Floats
    dress: Dress


def group_of(figures: Sequence[Figure]) -> Group:
    """One person or several."""
    begins = np.cumsum([0] + [len(one.vertices_m) for one in figures])
    shifted = [one.triangles + begin for one, begin in zip(figures, begins, strict=False)]
    return Group(
        figures=tuple(figures),
        triangles=np.concatenate(shifted).astype(np.int32),
        albedo=np.concatenate([one.albedo for one in figures]),
        dress=joined_dresses([one.dress for one in figures]),
    )


def posed_group(group: Group, bodies: Sequence[PersonBody]) -> Floats:
    """Vertices (V,3) in the world [m]."""
    posed = []
    for figure, body in zip(group.figures, bodies, strict=True):
        vertices = posed_figure(figure, body.pose, body.jacket)
        posed.append(vertices if body.screen is None else on_screen(vertices, body.screen))
    return posed[0] if len(posed) == 1 else np.concatenate(posed)


def visible_patches(figure: Figure, jacket: float) -> Bytes:
    """The shirt's patch of each triangle (T,), 0 also where the jacket is over it."""
    if jacket <= 0.0:
        return figure.patch
    dress = figure.dress
    x = dress.rest_m[figure.triangles, 0].mean(axis=1)
    hidden = (dress.under_jacket > 0) & (covered(x, dress.outfits[0, REACH], jacket) > 0.0)
    return np.where(hidden, 0, figure.patch).astype(np.uint8)
