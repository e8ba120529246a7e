"""Weights of a limb's particles: by points in space as in the paper, and by empty ellipsoids."""

from dataclasses import dataclass

import numpy as np

from mocapd.published.rao_hodges.chain_kernels import pose_chain, share_inside
from mocapd.published.rao_hodges.limb_chain import LimbChain
from mocapd.published.rao_hodges.point_cloud import PointCloud
from mocapd.types import Floats

_SAMPLES = 24  # of each ellipsoid
_GOLDEN_RAD = np.pi * (3.0 - np.sqrt(5.0))


@dataclass(frozen=True, slots=True, eq=False)
class PosedChain:
    """N particles of a chain in the world: R (N,E,3,3), joints_m (N,E,3)."""

    R: Floats
    joints_m: Floats


@dataclass(frozen=True, slots=True, eq=False)
class PointMatch:
    """inside (N,): which share of the points is in at least one ellipsoid, the paper's weight; full (N,E): how full of
    points each ellipsoid is, 0..1."""

    inside: Floats
    full: Floats

    def weight(self, converse: float) -> Floats:
        """(N,) the paper's weight, times how full the ellipsoids are on average to this power; 0 leaves that out."""
        if converse == 0.0:
            return self.inside
        weight: Floats = self.inside * self.full.mean(axis=-1) ** converse
        return weight


def pose_limb(chain: LimbChain, angles_rad: Floats, roots_R: Floats, roots_m: Floats) -> PosedChain:
    """Of angles (N,D) or (D,), at roots (N,3,3), (N,3) or one root (3,3), (3,); what is given once is for all particles."""
    n, a = max(angles_rad.size // max(chain.n_dof, 1) if angles_rad.ndim > 1 else 1,
               len(roots_m) if roots_m.ndim > 1 else 1), chain.arrays  # fmt: skip
    R, joints = np.empty((n, len(a.parents), 3, 3)), np.empty((n, len(a.parents), 3))
    pose_chain(
        np.ascontiguousarray(np.broadcast_to(angles_rad, (n, chain.n_dof))),
        np.ascontiguousarray(np.broadcast_to(roots_R, (n, 3, 3))),
        np.ascontiguousarray(np.broadcast_to(roots_m, (n, 3))), a.parents, a.joints_m, a.first_dof, a.axes, R, joints,
    )  # fmt: skip
    return PosedChain(R, joints)


def match_points(chain: LimbChain, pose: PosedChain, cloud: PointCloud) -> PointMatch:
    """Points against particles, and particles against points."""
    a = chain.arrays
    inside, held = np.zeros(len(pose.R)), np.zeros(pose.R.shape[:2])
    nearest = np.empty(cloud.count, np.float32)
    share_inside(
        pose.R, pose.joints_m, a.centres_m, a.radii_m, cloud.points_m, nearest, inside, held
    )
    expected = cloud.per_m3 * (4.0 / 3.0 * np.pi) * a.radii_m.prod(axis=1)
    return PointMatch(inside, np.minimum(held * cloud.count / expected, 1.0))


def ball_samples(count: int = _SAMPLES) -> Floats:
    """(S,3): points spread evenly over the unit ball, on a spiral with a radius growing by the cube root."""
    k = np.arange(count)
    # radii in another order than heights, so that each shell has samples all around
    radius = np.cbrt((k * 7 % count + 0.5) / count)
    height, angle = 1.0 - 2.0 * (k + 0.5) / count, _GOLDEN_RAD * k
    around = np.sqrt(1.0 - height**2)
    unit = np.stack([around * np.cos(angle), height, around * np.sin(angle)], axis=-1)
    samples: Floats = unit * radius[:, None]
    return samples


def places_within(chain: LimbChain, pose: PosedChain) -> Floats:
    """(N,E,S,3) [m, world]: places spread over each ellipsoid."""
    a = chain.arrays
    local = a.centres_m[:, None] + a.radii_m[:, None] * ball_samples()
    turned = np.matmul(local[None], np.swapaxes(pose.R, -1, -2))
    places: Floats = turned + pose.joints_m[:, :, None]
    return places
