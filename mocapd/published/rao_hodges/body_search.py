"""Searches for a whole body in points of the hull, in order root, legs, arms, each in the remaining points."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mocapd.geometry import rotations
from mocapd.published.rao_hodges.annealing import SearchSpace, Weigh, anneal
from mocapd.published.rao_hodges.body_chains import LIMBS, BodyChains, BodyPlace
from mocapd.published.rao_hodges.limb_chain import LimbChain
from mocapd.published.rao_hodges.limb_motion import search_space
from mocapd.published.rao_hodges.limb_weight import PointMatch, match_points, pose_limb
from mocapd.published.rao_hodges.params import Params
from mocapd.published.rao_hodges.point_cloud import PointCloud
from mocapd.types import Floats

_CELL_M = 0.15  # of the floor, in which points are counted
_NEAR_M = 0.45  # of the middle of a person: the trunk
_BAND = (0.40, 0.85)  # of the stature: heights of the trunk
_TOP, _BOTTOM = (
    0.75,
    0.30,
)  # of the stature: an upright person reaches above the first and below the second
_LEAST_POINTS = 60  # of a trunk


def match_body(body: BodyChains, place: BodyPlace, cloud: PointCloud) -> PointMatch:
    """The whole body against the points, as one particle."""
    pose = pose_limb(body.whole, place.angles, place.root_turn, place.root_m)
    return match_points(body.whole, pose, cloud)


def follow_body(
    body: BodyChains,
    place: BodyPlace,
    cloud: PointCloud,
    dt_s: float,
    rng: np.random.Generator,
    params: Params,
) -> tuple[BodyPlace, Floats]:
    """The body one frame of dt_s later, in these points, and the spread (18,) of its angles [rad]."""
    place = _follow_root(body, place, cloud, dt_s, rng, params)
    spread = np.zeros(body.whole.n_dof)
    left = _outside(body.trunk, np.empty(0), place, cloud)
    for name in LIMBS:
        chain, part = body.limbs[name], body.parts[name]
        weigh = _limb_weigher(chain, place, left, params.converse)
        found = anneal(place.angles[part], search_space(chain, dt_s), weigh, rng, params.annealing)
        place = place.with_limb(part, found.angles)
        spread[part] = found.spread
        left = _outside(chain, found.angles, place, left)
    return place, spread


def _limb_weigher(chain: LimbChain, place: BodyPlace, cloud: PointCloud, converse: float) -> Weigh:
    """The weight function of a limb's particles, with a fixed root."""

    def weigh(angles: Floats) -> Floats:
        pose = pose_limb(chain, angles, place.root_turn, place.root_m)
        return match_points(chain, pose, cloud).weight(converse)

    return weigh


def _follow_root(
    body: BodyChains,
    place: BodyPlace,
    cloud: PointCloud,
    dt_s: float,
    rng: np.random.Generator,
    params: Params,
) -> BodyPlace:
    """Shift and turn the body with its limbs at their last angles. Limbs that have moved since are empty: only the trunk
    must not be."""
    n_trunk = len(body.trunk.bones)
    p = params.root
    sd = np.array([p.sd_m] * 3 + [p.sd_rad] * 3) * dt_s
    free = np.full(6, np.inf)

    def roots(steps: Floats) -> tuple[Floats, Floats]:
        turns = rotations.to_matrix(rotations.exp(steps[:, 3:]))
        return turns @ place.root_turn, place.root_m + steps[:, :3]

    def weigh(steps: Floats) -> Floats:
        match = match_points(body.whole, pose_limb(body.whole, place.angles, *roots(steps)), cloud)
        return PointMatch(match.inside, match.full[:, :n_trunk]).weight(params.root_converse)

    found = anneal(np.zeros(6), SearchSpace(sd, -free, free), weigh, rng, params.annealing)
    R, at_m = roots(found.angles[None])
    return BodyPlace(at_m[0], R[0], place.angles)


def upright_place(points_m: Floats, stature_m: float) -> Floats | None:
    """Position (3,) on the floor of an upright person of this stature [m] in points (P,3); None without one."""
    heights = points_m[:, 1] / stature_m
    trunk = points_m[(heights > _BAND[0]) & (heights < _BAND[1])]
    if len(trunk) < _LEAST_POINTS:
        return None
    cells = np.floor(trunk[:, [0, 2]] / _CELL_M).astype(np.int64)
    grid = np.zeros(np.ptp(cells, axis=0) + 3)
    np.add.at(grid, tuple((cells - cells.min(axis=0) + 1).T), 1.0)
    about = sum(np.roll(grid, (a, b), (0, 1)) for a in (-1, 0, 1) for b in (-1, 0, 1))
    peak = np.array(np.unravel_index(int(np.argmax(about)), grid.shape)) + cells.min(axis=0) - 1
    middle = (peak + 0.5) * _CELL_M
    near = trunk[np.linalg.norm(trunk[:, [0, 2]] - middle, axis=1) < _NEAR_M]
    if len(near) < _LEAST_POINTS:
        return None
    middle = np.median(near[:, [0, 2]], axis=0)
    column = heights[np.linalg.norm(points_m[:, [0, 2]] - middle, axis=1) < _NEAR_M]
    if np.percentile(column, 97) < _TOP or np.percentile(column, 3) > _BOTTOM:
        return None
    return np.array([middle[0], 0.0, middle[1]])


def start_body(
    body: BodyChains, floor_m: Floats, cloud: PointCloud, rng: np.random.Generator, params: Params
) -> BodyPlace:
    """The best body at a place (3,) of the floor, over all facing directions, with the arms out or down."""
    p = params.root
    guesses = _stances(body, floor_m, 2.0 * np.pi * np.arange(p.yaws) / p.yaws, p.raised_rad)
    place = _heaviest(body, guesses, cloud, params)
    # straight legs on flat feet distinguish front from back; moved limbs do so less
    careful = replace(params, converse=params.root_converse)
    for _ in range(p.refinements):
        place, _ = follow_body(body, place, cloud, p.refinement_dt_s, rng, careful)
    return place


def _stances(
    body: BodyChains, floor_m: Floats, yaws_rad: Floats, lowered_rad: Sequence[float]
) -> list[BodyPlace]:
    root = floor_m + np.array([0.0, body.hips_height_m, 0.0])
    out = []
    for yaw in yaws_rad:
        R = rotations.to_matrix(rotations.exp(np.array([0.0, yaw, 0.0])))
        for lowered in lowered_rad:
            angles = np.zeros(body.whole.n_dof)
            for side, sign in (("left_arm", -1.0), ("right_arm", 1.0)):
                angles[body.parts[side]] = (0.0, 0.0, sign * lowered, 0.2)
            out.append(BodyPlace(root, R, angles))
    return out


def _heaviest(
    body: BodyChains, places: Sequence[BodyPlace], cloud: PointCloud, params: Params
) -> BodyPlace:
    pose = pose_limb(
        body.whole,
        np.array([place.angles for place in places]),
        np.array([place.root_turn for place in places]),
        np.array([place.root_m for place in places]),
    )
    weights = match_points(body.whole, pose, cloud).weight(params.root_converse)
    return places[int(np.argmax(weights))]


def _outside(chain: LimbChain, angles: Floats, place: BodyPlace, cloud: PointCloud) -> PointCloud:
    """The points that are in none of a chain's ellipsoids."""
    pose, a = pose_limb(chain, angles, place.root_turn, place.root_m), chain.arrays
    outside = np.ones(cloud.count, dtype=bool)
    for R, joint, centre, radii in zip(
        pose.R[0], pose.joints_m[0], a.centres_m, a.radii_m, strict=True
    ):
        local = ((cloud.points_m.T - joint) @ R - centre) / radii
        outside &= (local * local).sum(axis=1) > 1.0
    return cloud.where(outside)
