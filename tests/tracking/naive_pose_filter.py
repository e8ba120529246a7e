"""`pose_filter_kernels.follow_bones` as a formula over all bones at once."""

import numpy as np

from mocapd.geometry import rotations
from mocapd.types import Floats


def followed(
    found_xyzw: Floats,
    last_xyzw: Floats,
    trust: Floats,
    following: Floats,
    gap_s: float,
    ticks: float,
    learns: float,
    memory: Floats,
    turning_rad_s: Floats,
) -> tuple[Floats, Floats, Floats]:
    """The filtered bones (J,4), how they turn (J,3), and what is remembered (J,5)."""
    all_sure, doubtful, least, doubtful_rad_s, sure_rad_s, power, goes_on, noise_rad = following
    sure = np.clip((trust - doubtful) / (all_sure - doubtful), 0.0, 1.0) ** power
    follows = 1.0 - ((1.0 - least) * (1.0 - sure)) ** ticks
    learned = 1.0 - (1.0 - learns * np.sqrt(sure)) ** ticks
    turning = goes_on[:, None] ** ticks * turning_rad_s
    expected = rotations.multiply(rotations.exp(gap_s * turning), last_xyzw)
    way = rotations.log(rotations.multiply(found_xyzw, rotations.inverse(expected)))
    keeps, length = 0.85**ticks, np.linalg.norm(way, axis=1)
    means = keeps * memory[:, :4] + (1.0 - keeps) * np.column_stack([way, length])
    fastest = np.maximum(np.linalg.norm(turning_rad_s, axis=1), 0.95**ticks * memory[:, 4])
    one_way = (means[:, :3] ** 2).sum(axis=1) / means[:, 3] ** 2
    far = np.divide(length, noise_rad, out=np.full(len(length), np.inf), where=noise_rad > 0.0)
    fast = np.divide(fastest, 10.0 * noise_rad, out=np.ones(len(length)), where=noise_rad > 0.0)
    moves = np.max([one_way, fast**2, far**2], axis=0)
    share = follows * (0.05 + 0.95 * np.minimum(moves, 1.0))
    filtered = rotations.multiply(rotations.exp(share[:, None] * way), expected)
    turn = rotations.log(rotations.multiply(filtered, rotations.inverse(last_xyzw)))
    most_rad = gap_s * (doubtful_rad_s + (sure_rad_s - doubtful_rad_s) * sure)
    turn *= np.minimum(1.0, most_rad / np.maximum(np.linalg.norm(turn, axis=1), 1e-9))[:, None]
    filtered = rotations.canonical(rotations.multiply(rotations.exp(turn), last_xyzw))
    return (
        filtered,
        turning + learned[:, None] * (turn / gap_s - turning),
        np.column_stack([means, fastest]),
    )
