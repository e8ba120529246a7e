"""Cameras whose pictures are mirrored, and a back glued on upside down, told by what does not fit together.

The mirror image of a two-sided board is that of a two-sided board: its front looks as the back does, so no
picture shows by itself that it is mirrored. But between two cameras each position of the board says where
one stands as seen from the other, and all must say the same. A camera that is mirrored agrees with the
others when its views are turned back, a back upside down when it is taken for one. Pictures that are
mirrored in all cameras make a room that is mirrored and fits as well; what tells it is a board on the
floor, which seems to lie on its face.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from mocapd.calibrate.board.back_side import usual_back
from mocapd.geometry.rigid_transforms import RigidTransform, stack
from mocapd.types import Floats

_FEWEST = 3  # positions that two cameras share, as for a link of the pose graph
_LOOSE = 0.15  # scatter [rad, and 1 m counts as 1 rad] under which nothing is suspected
_MUCH_BETTER = 0.5  # part of the scatter that another explanation may leave
_MOST = 1.0  # of one pair: nonsense is no worse than nonsense
_MIRROR = np.diag([-1.0, 1.0, 1.0])
_THROUGH_BOARD = np.diag([1.0, 1.0, -1.0])


@dataclass(frozen=True, slots=True)
class Suspicion:
    """What the positions say together: `mirrored` cameras, or as well `others` instead (none: certainly those);
    `upside_down`: the back of the board."""

    mirrored: tuple[str, ...]
    others: tuple[str, ...]
    upside_down: bool


@dataclass(frozen=True, slots=True, eq=False)
class SeenPose:
    """camera_from_print of one view, as if the print were on the front, and whether it is the back's."""

    camera_from_print: RigidTransform
    back: bool


def suspect(
    names: Sequence[str],
    poses: Mapping[str, Mapping[int, SeenPose]],
    board_m: Floats,
) -> Suspicion | None:
    """None where the cameras fit as they are, or nothing makes them fit; `poses[camera][index]`."""
    pairs = [(a, b, sorted(poses[a].keys() & poses[b].keys())) for a, b in combinations(names, 2)]
    pairs = [(a, b, shared) for a, b, shared in pairs if len(shared) >= _FEWEST]
    if not pairs:
        return None
    best: tuple[float, frozenset[str], bool] | None = None
    usual = 0.0
    for upside_down in (False, True):
        scatter = {
            (a, b, differ): _scatter(
                [_placed(poses[a][i], differ, upside_down, board_m) for i in shared],
                [_placed(poses[b][i], False, upside_down, board_m) for i in shared],
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
    """The cameras to be taken for mirrored, one after the other as long as that helps; the scatter then."""

    def cost(mirrored: frozenset[str]) -> float:
        return sum(scatter[a, b, (a in mirrored) != (b in mirrored)] for a, b in pairs)

    mirrored: frozenset[str] = frozenset()
    while True:
        best = min((mirrored ^ {name} for name in names), key=cost)
        if cost(best) >= cost(mirrored):
            return mirrored, cost(mirrored)
        mirrored = best


def _placed(seen: SeenPose, mirrored: bool, upside_down: bool, board_m: Floats) -> RigidTransform:
    """camera_from_board, if the picture was mirrored or the back is upside down."""
    pose, back = seen.camera_from_print, seen.back
    if mirrored:
        back = not back
        pose = RigidTransform(_MIRROR @ pose.R @ _THROUGH_BOARD, _MIRROR @ pose.t_m)
    if not back:
        return pose
    half_turn = np.array([0.0, 0.0, np.pi if upside_down else 0.0, 0.0])
    return pose @ usual_back(board_m).with_step(half_turn).board_from_back.inverse()


def _scatter(a: Sequence[RigidTransform], b: Sequence[RigidTransform]) -> float:
    """How far what the positions say of a_from_b is from the one nearest to all [rad, m]."""
    said = stack([one @ other.inverse() for one, other in zip(a, b, strict=True)])
    return min(_MOST, float(np.median(distances(said), axis=1).min()))


def distances(transforms: RigidTransform) -> Floats:
    """(N,N) between those of a batch (N,): the angle [rad] and the distance [m], 1 m as bad as 1 rad."""
    R, t_m = transforms.R, transforms.t_m
    cosines = np.clip((np.einsum("aij,bij->ab", R, R) - 1.0) / 2.0, -1.0, 1.0)
    far: Floats = np.arccos(cosines) + np.linalg.norm(t_m[:, None] - t_m, axis=2)
    return far
