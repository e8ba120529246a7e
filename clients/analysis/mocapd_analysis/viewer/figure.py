"""A person of cylinders, and trails, as arrays for whoever draws. Pure."""

import numpy as np

from mocapd.types import Floats, Ints
from mocapd_analysis.session import Session

TRAIL_POINTS = 61
_THICKNESS_M = {
    "spine": 0.085, "chest": 0.09, "upperChest": 0.085, "neck": 0.05, "head": 0.045,
    "UpperLeg": 0.06, "LowerLeg": 0.055, "Foot": 0.04, "Toes": 0.03,
    "Shoulder": 0.045, "UpperArm": 0.045, "LowerArm": 0.038, "Hand": 0.03,
}  # fmt: skip
HEAD_M = 0.105  # radius


def pose_at(session: Session, at_s: float) -> Floats | None:
    """The joints (J,3) [m] at a time between the frames; None before, after, and in a gap."""
    times_s = session.times_s
    if not times_s[0] - 1e-9 <= at_s <= times_s[-1] + 1e-9 or is_gap(session, at_s):
        return None
    after = min(int(np.searchsorted(times_s, at_s, side="left")), len(times_s) - 1)
    before = max(after - 1, 0)
    between_s = float(times_s[after] - times_s[before])
    if between_s <= 0.0:
        return np.asarray(session.joints_m[after])
    share = np.clip((at_s - times_s[before]) / between_s, 0.0, 1.0)
    mixed: Floats = (1.0 - share) * session.joints_m[before] + share * session.joints_m[after]
    return mixed


def is_gap(session: Session, at_s: float) -> bool:
    """Whether nobody was tracked at a time."""
    return any(start_s < at_s < end_s for start_s, end_s in session.gaps_s)


def trail_at(session: Session, name: str, at_s: float, length_s: float) -> Floats:
    """Where a joint was (TRAIL_POINTS,3) [m] in the time before, at equal times; it does not cross a gap."""
    times_s = session.times_s
    begin_s = at_s - length_s
    for _, gap_end_s in session.gaps_s:
        if gap_end_s <= at_s:
            begin_s = max(begin_s, gap_end_s)
    if is_gap(session, at_s):
        begin_s = at_s
    wanted_s = np.linspace(min(begin_s, at_s), at_s, TRAIL_POINTS)
    way = session.positions_m(name)
    return np.stack([np.interp(wanted_s, times_s, way[:, axis]) for axis in range(3)], axis=1)


def thickness_m(name: str) -> float:
    """Of the cylinder that ends at this joint [m, radius]."""
    plain = name.removeprefix("left").removeprefix("right")
    return _THICKNESS_M.get(plain, 0.04)


def cylinders(joints_m: Floats, parents: Ints, radii_m: Floats) -> tuple[Floats, Floats, Floats]:
    """Middle (N,3), rotation wxyz (N,4) and scale (N,3) of a unit cylinder about +Y for each joint with a parent."""
    child = np.flatnonzero(parents >= 0)
    a, b = joints_m[parents[child]], joints_m[child]
    apart = b - a
    length = np.linalg.norm(apart, axis=1)
    along = apart / np.maximum(length, 1e-9)[:, None]
    along[length < 1e-9] = (0.0, 1.0, 0.0)
    scale = np.stack([radii_m[child], length, radii_m[child]], axis=1)
    return 0.5 * (a + b), _from_up_wxyz(along), scale


def _from_up_wxyz(along: Floats) -> Floats:
    """The shortest turns (N,4) that take +Y to unit vectors (N,3)."""
    quats = np.stack([1.0 + along[:, 1], along[:, 2], np.zeros(len(along)), -along[:, 0]], axis=1)
    quats[along[:, 1] < -1.0 + 1e-9] = (0.0, 1.0, 0.0, 0.0)  # straight down: about +X
    turned: Floats = quats / np.linalg.norm(quats, axis=1, keepdims=True)
    return turned


def unit_cylinder(sides: int = 14) -> tuple[Floats, Ints]:
    """Vertices and triangles: radius 1, from -0.5 to 0.5 along +Y, closed."""
    turn = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    ring = np.stack([np.cos(turn), np.zeros(sides), np.sin(turn)], axis=1)
    low, high = ring - [0.0, 0.5, 0.0], ring + [0.0, 0.5, 0.0]
    vertices = np.concatenate([low, high, [[0.0, -0.5, 0.0], [0.0, 0.5, 0.0]]])
    here = np.arange(sides)
    after = (here + 1) % sides
    bottom, top = np.full(sides, 2 * sides), np.full(sides, 2 * sides + 1)
    faces = np.concatenate(
        [
            np.stack([here, here + sides, after], axis=1),
            np.stack([after, here + sides, after + sides], axis=1),
            np.stack([bottom, here, after], axis=1),
            np.stack([top, after + sides, here + sides], axis=1),
        ]
    )
    return vertices, faces


def unit_sphere(rings: int = 7, sides: int = 12) -> tuple[Floats, Ints]:
    """Vertices and triangles of a sphere of radius 1."""
    down = np.linspace(0.0, np.pi, rings + 2)[1:-1]
    turn = np.linspace(0.0, 2.0 * np.pi, sides, endpoint=False)
    around = np.stack(
        [
            np.outer(np.sin(down), np.cos(turn)),
            np.outer(np.cos(down), np.ones(sides)),
            np.outer(np.sin(down), np.sin(turn)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    vertices = np.concatenate([around, [[0.0, 1.0, 0.0], [0.0, -1.0, 0.0]]])
    here = np.arange(sides)
    after = (here + 1) % sides
    top, bottom = np.full(sides, rings * sides), np.full(sides, rings * sides + 1)
    last = (rings - 1) * sides
    faces = [
        np.stack([top, after, here], axis=1),
        np.stack([bottom, last + here, last + after], axis=1),
    ]
    for ring in range(rings - 1):
        a, b = ring * sides, (ring + 1) * sides
        faces.append(np.stack([a + here, a + after, b + here], axis=1))
        faces.append(np.stack([a + after, b + after, b + here], axis=1))
    return vertices, np.concatenate(faces)
