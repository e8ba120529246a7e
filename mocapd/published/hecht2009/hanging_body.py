"""The body at the start: it hangs relaxed from the head, until the pictures match it [Hecht et al. 2009, III.C]."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.geometry.camera_model import centre
from mocapd.published.hecht2009.head.head_track import HeadTrack
from mocapd.published.hecht2009.mass_spring.mass_spring_body import MassSpringBody
from mocapd.published.hecht2009.mass_spring.simulation import (
    MassSpringState,
    head_middle,
    relaxed_state,
    simulate,
    with_head,
)
from mocapd.published.hecht2009.params import FLOOR_M, Params
from mocapd.types import Camera, Floats


@dataclass(frozen=True, slots=True, eq=False)
class HangingBody:
    """The body's points, and its initial facing direction: an angle about +Y from +Z."""

    state: MassSpringState
    facing_rad: float


def hang(
    last: HangingBody | None,
    body: MassSpringBody,
    head: HeadTrack,
    dt_s: float,
    cameras: Sequence[Camera],
    params: Params,
) -> HangingBody:
    """The last hanging body after dt_s, moved with the head; or a new one where there is none, or the head turned or jumped.

    A head whose yaw is unknown faces the cameras. The head has a place.
    """
    middle = head.middle_m
    assert middle is not None
    facing = head.yaw_rad
    if last is not None:
        turned = 0.0 if facing is None else _apart_rad(facing, last.facing_rad)
        moved_m = float(np.linalg.norm(head_middle(body, last.state) - middle))
        if turned < params.rehang_rad and moved_m < params.rehang_m:
            state = with_head(body, last.state, middle, params.simulation)
            state = simulate(body, state, dt_s, floor_m=FLOOR_M, params=params.simulation)
            return replace(last, state=state)
    if facing is None:
        facing = _towards_cameras_rad(cameras, middle)
    return HangingBody(relaxed_state(body, middle, facing, FLOOR_M, params.simulation), facing)


def _towards_cameras_rad(cameras: Sequence[Camera], middle_m: Floats) -> float:
    ways = np.array([centre(camera) - middle_m for camera in cameras])[:, [0, 2]]
    way = (ways / np.linalg.norm(ways, axis=1, keepdims=True)).mean(axis=0)
    return float(np.arctan2(way[0], way[1]))


def _apart_rad(a: float, b: float) -> float:
    return abs((a - b + np.pi) % (2.0 * np.pi) - np.pi)
