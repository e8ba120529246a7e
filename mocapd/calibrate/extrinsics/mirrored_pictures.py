"""Detects mirrored pictures, and an upside-down back of a two-sided board, by contradictions between cameras.

The mirror image of a two-sided board is a valid two-sided board: its front looks as the back does, so no single picture
shows that it is mirrored. But each board position in two cameras gives their relative pose, and all must agree. A
mirrored camera agrees with the others when its views are mirrored back, and an upside-down back when it is modelled so.
Pictures that are mirrored in all cameras give a mirrored room with the same fit; then a board on the floor seems to lie
on its face.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from mocapd.calibrate.board.back_side import usual_back
from mocapd.geometry.rigid_transforms import RigidTransform, stack
from mocapd.types import Floats

_FEWEST = 3  # common positions of two cameras, as for an edge of the pose graph
_LOOSE = 0.15  # scatter [rad, and 1 m counts as 1 rad] that needs no explanation
_MUCH_BETTER = 0.5  # largest part of the scatter that an explanation may leave
_MOST = 1.0  # upper bound of one pair
_MIRROR = np.diag([-1.0, 1.0, 1.0])
_THROUGH_BOARD = np.diag([1.0, 1.0, -1.0])


@dataclass(frozen=True, slots=True)
class Suspicion:
    """The result: `mirrored` cameras, or equally well `others` instead (none: certainly those); `upside_down`: the back of
    the board."""

    mirrored: tuple[str, ...]
    others: tuple[str, ...]
    upside_down: bool


@dataclass(frozen=True, slots=True, eq=False)
class PrintPose:
    """camera_from_print of one view, as if the print were on the front; back: whether it is the back's."""

    camera_from_print: RigidTransform
    back: bool


def suspect(
    names: Sequence[str], poses: Mapping[str, Mapping[int, PrintPose]], board_m: Floats
) -> Suspicion | None:
    """None where the cameras fit as they are, or no hypothesis makes them fit; `poses[camera][index]`."""
    pairs = [(a, b, sorted(poses[a].keys() & poses[b].keys())) for a, b in combinations(names, 2)]
    pairs = [(a, b, shared) for a, b, shared in pairs if len(shared) >= _FEWEST]
    if not pairs:
        return None
    best: tuple[float, frozenset[str], bool] | None = None
    usual = 0.0
    for upside_down in (False, True):
        scatter = {
            (a, b, differ): _scatter(
                [_board_pose(poses[a][i], differ, upside_down, board_m) for i in shared],
                [_board_pose(poses[b][i], False, upside_down, board_m) for i in shared],
            )
            for a, b, shared in pairs
            for differ in (False, True)
        }
        mirrored, cost = _descend(names, [(a, b) for a, b, _ in pairs], scatter)
        if not upside_down:
            usual = sum(scatter[a, b, False] for a, b, _ in pairs)
        if best is None or cost < _MUCH_BETTER * best[0]:
            best = cost, mirrored, upside_down
    assert best is not None
    cost, mirrored, upside_down = best
    if usual < _LOOSE * len(pairs) or cost > _MUCH_BETTER * usual:
        return None
    groups = sorted((set(mirrored), set(names) - mirrored), key=len)
    fewer, more = (tuple(name for name in names if name in group) for group in groups)
    return Suspicion(fewer, more if len(fewer) == len(more) else (), upside_down)


def _descend(
    names: Sequence[str],
    pairs: Sequence[tuple[str, str]],
    scatter: Mapping[tuple[str, str, bool], float],
) -> tuple[frozenset[str], float]:
    """Greedy search for the set of mirrored cameras with the least scatter; returns both."""

    def cost(mirrored: frozenset[str]) -> float:
        return sum(scatter[a, b, (a in mirrored) != (b in mirrored)] for a, b in pairs)

    mirrored: frozenset[str] = frozenset()
    while True:
        best = min((mirrored ^ {name} for name in names), key=cost)
        if cost(best) >= cost(mirrored):
            return mirrored, cost(mirrored)
        mirrored = best


def _board_pose(
    print_pose: PrintPose, mirrored: bool, upside_down: bool, board_m: Floats
) -> RigidTransform:
    """camera_from_board, for a mirrored picture or an upside-down back."""
    pose, back = print_pose.camera_from_print, print_pose.back
    if mirrored:
        back = not back
        pose = RigidTransform(_MIRROR @ pose.R @ _THROUGH_BOARD, _MIRROR @ pose.t_m)
    if not back:
        return pose
    half_turn = np.array([0.0, 0.0, np.pi if upside_down else 0.0, 0.0])
    return pose @ usual_back(board_m).with_step(half_turn).board_from_back.inverse()


def _scatter(a: Sequence[RigidTransform], b: Sequence[RigidTransform]) -> float:
    """Scatter of the positions' a_from_b about their medoid [rad, m]."""
    relative = stack([one @ other.inverse() for one, other in zip(a, b, strict=True)])
    return min(_MOST, float(np.median(distances(relative), axis=1).min()))


def distances(transforms: RigidTransform) -> Floats:
    """(N,N) between transforms of a batch (N,): the angle [rad] and the distance [m], 1 m as bad as 1 rad."""
    R, t_m = transforms.R, transforms.t_m
    cosines = np.clip((np.einsum("aij,bij->ab", R, R) - 1.0) / 2.0, -1.0, 1.0)
    far: Floats = np.arccos(cosines) + np.linalg.norm(t_m[:, None] - t_m, axis=2)
    return far
