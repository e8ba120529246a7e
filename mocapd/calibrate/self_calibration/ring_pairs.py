"""Sleeve rings that two cameras saw at one instant."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.skeleton import INDEX
from mocapd.calibrate.self_calibration.patch_tracks import PatchObservation, PatchSighting
from mocapd.calibrate.self_calibration.sleeve_rings import N_ALONG, SIDES, sleeve_rings
from mocapd.clock import nanoseconds
from mocapd.geometry.camera_model import to_camera
from mocapd.geometry.triangulation import triangulate
from mocapd.types import Camera, Floats

_ARMS = np.array([INDEX[s + b] for s in SIDES for b in ("UpperArm", "LowerArm", "Hand")])
_SAME_NS = nanoseconds(1e-4)
_USUAL = 65.0  # percentile of a ring's width: narrower ones are half hidden
_UNLIKE = 0.22
_MOST = 160  # observations: 15 s of a core


@dataclass(frozen=True, slots=True, eq=False)
class RingPairs:
    """xy (2,G,P,2): rings of G arms in both cameras, undistorted normalised; visible (G,P): in both."""

    xy: Floats
    visible: NDArray[np.bool_]


def ring_pairs(
    observations: Sequence[PatchObservation], pair: tuple[Camera, Camera], scales: tuple[int, int]
) -> RingPairs:
    """Rings of observations by both cameras; the second camera's rings are interpolated to the first's instants. `pair`:
    the cameras with approximate extrinsics."""
    shared = [m for m in observations if all(camera.name in m for camera in pair)]
    picked = np.unique(np.linspace(0, len(shared) - 1, min(_MOST, len(shared))).astype(np.int64))
    n = len(picked)
    xy, half_m = np.full((2, n, 2 * N_ALONG, 2), np.nan), np.full((2, n, 2 * N_ALONG), np.nan)
    for row, k in enumerate(picked):
        xy[0, row], half_m[0, row] = _rings(shared[k], 0, pair, scales)
        second = _rings(shared[k], 1, pair, scales)
        ahead_ns = shared[k][pair[0].name].t_ns - shared[k][pair[1].name].t_ns
        if abs(ahead_ns) > _SAME_NS:
            other = int(k) + (1 if ahead_ns > 0 else -1)
            if not 0 <= other < len(shared):
                continue
            way_ns = shared[other][pair[1].name].t_ns - shared[k][pair[1].name].t_ns
            share = ahead_ns / way_ns if way_ns else np.inf
            if not 0.0 <= share <= 1.0:
                continue
            neighbour = _rings(shared[other], 1, pair, scales)
            second = (
                (1.0 - share) * second[0] + share * neighbour[0],
                (1.0 - share) * second[1] + share * neighbour[1],
            )
        xy[1, row], half_m[1, row] = second
    arms = xy.reshape(2, 2 * n, N_ALONG, 2)  # a view
    width_m = half_m.reshape(2, 2 * n, N_ALONG)
    for p in range(N_ALONG):
        of_ring = width_m[..., p][np.isfinite(width_m[..., p])]
        if len(of_ring):
            usual = np.percentile(of_ring, _USUAL)
            arms[..., p, :][~(np.abs(width_m[..., p] / usual - 1.0) < _UNLIKE)] = np.nan
    visible = np.isfinite(arms).all(axis=(0, 3))
    in_any = visible.any(axis=1)
    return RingPairs(np.where(visible[..., None], arms, 0.0)[:, in_any], visible[in_any])


def _rings(
    observation: PatchObservation, i: int, pair: tuple[Camera, Camera], scales: tuple[int, int]
) -> tuple[Floats, Floats]:
    """Of one of the two cameras, as `sleeve_rings`."""
    sightings = [observation[camera.name] for camera in pair]
    joints_m = _arms_in_depth(sightings, pair)[i]
    return sleeve_rings(sightings[i], joints_m, pair[i], scales[i])


def _arms_in_depth(sightings: Sequence[PatchSighting], pair: Sequence[Camera]) -> list[Floats]:
    """Each camera's joints (J,3) with the arms at the depth of the joint solution.

    A single camera errs in an arm's direction towards it, and may have it the wrong way round.
    """
    points = np.stack([s.joints_m[_ARMS] for s in sightings])
    weights = np.stack([s.confidence[_ARMS] for s in sightings]) + 1e-3
    placed, _ = triangulate(pair, points[..., :2] / points[..., 2:], weights)
    out = []
    for sighting, camera in zip(sightings, pair, strict=True):
        joints = sighting.joints_m.copy()
        depth = to_camera(camera, placed)[:, 2]
        valid = np.isfinite(depth) & (depth > 0.5)
        arms = _ARMS[valid]
        joints[arms] *= (depth[valid] / joints[arms, 2])[:, None]
        out.append(joints)
    return out
