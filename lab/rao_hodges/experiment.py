"""The experiment of Rao and Hodges, section 6: limbs tracked in synthetic points of real motion, their root given."""

import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from lab.rao_hodges.clip_angles import LimbAngles, angle_errors
from lab.rao_hodges.silhouette_weight import SilhouetteWeight
from lab.rao_hodges.synthetic_views import cameras_around, silhouettes_of
from mocapd.body.skeleton import standard_skeleton
from mocapd.published.rao_hodges.annealing import AnnealingParams, SearchSpace, Weigh, anneal
from mocapd.published.rao_hodges.limb_chain import LimbChain, arm, legs
from mocapd.published.rao_hodges.limb_motion import search_space
from mocapd.published.rao_hodges.limb_weight import (
    match_points,
    places_within,
    pose_limb,
)
from mocapd.published.rao_hodges.point_cloud import point_cloud
from mocapd.types import Floats

STATURE_M = 1.75
_ROOT_R, _ROOT_M = np.eye(3), np.array([0.0, 0.95, 0.0])
_APART_M = 0.15  # of the ankles on average: nearer legs are not counted as exchanged
_LEFT, _RIGHT = (1, 2), (4, 5)  # shanks and feet of the legs' chain


@dataclass(frozen=True, slots=True)
class LimbVariant:
    """points: synthetic ones of each frame; converse: exponent of the term against empty ellipsoids, 0 as published;
    silhouettes: the weight in four pictures instead of in space; components: search in so many principal components."""

    label: str
    points: int = 1000
    converse: float = 0.0
    annealing: AnnealingParams = field(default_factory=AnnealingParams)
    silhouettes: bool = False
    components: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class LimbOutcome:
    """One limb of one clip: errors_deg (F,D) of each angle, absolute; spread_deg (F,) mean standard deviation of the selected
    particles; exchanged, apart: frames with the legs exchanged, of those in which they are apart; cpu_s: of the tracking."""

    errors_deg: Floats
    spread_deg: Floats
    exchanged: int
    apart: int
    cpu_s: float


@cache
def chains() -> dict[str, LimbChain]:
    """By limb, of a person of mean proportions."""
    skeleton = standard_skeleton(STATURE_M)
    arms = {f"{side}_arm": arm(skeleton, STATURE_M, side) for side in ("left", "right")}
    return {"legs": legs(skeleton, STATURE_M), **arms}


def points_in(chain: LimbChain, angles: Floats, count: int, rng: np.random.Generator) -> Floats:
    """(P,3) [m]: random points of the ellipsoids of a pose (D,), each ellipsoid as many as its volume deserves."""
    pose, a = pose_limb(chain, angles, _ROOT_R, _ROOT_M), chain.arrays
    volume = a.radii_m.prod(axis=1)
    which = rng.choice(len(volume), count, p=volume / volume.sum())
    way = rng.standard_normal((count, 3))
    way *= np.cbrt(rng.random(count))[:, None] / np.linalg.norm(way, axis=1, keepdims=True)
    local = a.centres_m[which] + a.radii_m[which] * way
    points: Floats = np.einsum("pij,pj->pi", pose.R[0, which], local) + pose.joints_m[0, which]
    return points


def principal_space(
    space: SearchSpace, others: Sequence[LimbAngles], components: int
) -> SearchSpace:
    """The space of the first principal components of other clips' angles; its noise is a third of the 99.5th percentile of
    the steps along each."""
    every = np.concatenate([one.angles for one in others])
    mean = every.mean(axis=0)
    _, _, axes = np.linalg.svd(every - mean, full_matrices=False)
    basis = axes[:components].T
    steps = np.concatenate([np.abs(np.diff(one.angles @ basis, axis=0)) for one in others])
    sd = np.percentile(steps, 99.5, axis=0) / 3.0
    return SearchSpace(sd, space.lower, space.upper, mean, basis)


def track_limb(
    truth: LimbAngles, variant: LimbVariant, seed: int, others: Sequence[LimbAngles] = ()
) -> LimbOutcome:
    """Track one limb through a clip, from the true angles of its first frame on."""
    chain = chains()[truth.limb]
    space = search_space(chain, truth.dt_s)
    angles = np.clip(truth.angles, space.lower, space.upper)
    if variant.components:
        space = principal_space(space, others, variant.components)
    rng, now = np.random.default_rng(seed), angles[0]
    errors, spread, cpu_s = [], [], 0.0
    exchanged = apart = 0
    for true in angles[1:]:
        weigh = _weigher(chain, true, variant, rng)
        begun_s = time.process_time()
        found = anneal(now, space, weigh, rng, variant.annealing)
        cpu_s += time.process_time() - begun_s
        now = found.angles
        errors.append(angle_errors(truth.limb, now, true))
        spread.append(found.spread.mean())
        if truth.limb == "legs":
            counted, wrong = _exchanged(chain, now, true)
            apart += counted
            exchanged += wrong
    return LimbOutcome(np.degrees(errors), np.degrees(spread), exchanged, apart, cpu_s)


def _weigher(
    chain: LimbChain, true: Floats, variant: LimbVariant, rng: np.random.Generator
) -> Weigh:
    """The weight of particles against one frame's points or silhouettes."""
    if variant.silhouettes:
        cameras = cameras_around(_ROOT_M)
        in_pictures = SilhouetteWeight(
            cameras, silhouettes_of(chain, pose_limb(chain, true, _ROOT_R, _ROOT_M), cameras)
        )
        return lambda angles: in_pictures(chain, pose_limb(chain, angles, _ROOT_R, _ROOT_M))
    volume_m3 = 4.0 / 3.0 * np.pi * chain.arrays.radii_m.prod(axis=1).sum()
    cloud = point_cloud(points_in(chain, true, variant.points, rng), variant.points / volume_m3)
    return lambda angles: match_points(
        chain, pose_limb(chain, angles, _ROOT_R, _ROOT_M), cloud
    ).weight(variant.converse)


def _exchanged(chain: LimbChain, found: Floats, true: Floats) -> tuple[int, int]:
    """Whether the lower legs are apart, and whether each is where the other should be."""
    mine, its = (
        places_within(chain, pose_limb(chain, one, _ROOT_R, _ROOT_M))[0].mean(axis=1)
        for one in (found, true)
    )
    between_m = np.linalg.norm(its[list(_LEFT)] - its[list(_RIGHT)], axis=1).mean()
    if between_m < _APART_M:
        return 0, 0
    straight, crossed = (
        np.linalg.norm(mine[[*_LEFT, *_RIGHT]] - its[list(order)], axis=1).sum()
        for order in ((*_LEFT, *_RIGHT), (*_RIGHT, *_LEFT))
    )
    return 1, int(crossed < straight)
