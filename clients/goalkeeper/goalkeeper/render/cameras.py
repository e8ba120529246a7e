"""Where one looks from: the keeper's eyes, behind the goal, or around the best save."""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from goalkeeper.core.limbs import LimbPose
from goalkeeper.core.pitch import GOAL_LINE_Z_M
from goalkeeper.render.panda_space import to_panda
from mocapd.types import Floats

_FOLLOW_PER_S = 9.0  # how fast the camera is where it should be


class View(StrEnum):
    """What the player chose."""

    BEHIND = "behind"
    FIRST = "first"


@dataclass(frozen=True, slots=True, eq=False)
class Framing:
    """A camera in the goal's frame: place and what it looks at (3,) [m], horizontal field of view [deg]."""

    place_m: Floats
    target_m: Floats
    fov_deg: float


def keeper_camera(view: View, pose: LimbPose | None) -> Framing:
    """While it is played."""
    chest_m = pose.point("upperChest") if pose is not None else np.array([0.0, 1.3, 0.0])
    if view is View.FIRST:
        eyes_m = pose.point("head") if pose is not None and pose.knows("head") else chest_m
        return Framing(eyes_m + [0.0, 0.16, -0.30], eyes_m + [0.0, -0.85, 9.0], 84.0)
    x_m = float(np.clip(chest_m[0], -1.0, 1.0))
    # higher than the keeper's head, so that shooter and ball are seen above it
    return Framing(
        np.array([0.55 * x_m, 2.75, GOAL_LINE_Z_M - 3.7]), np.array([0.30 * x_m, 0.22, 4.0]), 67.0
    )


def replay_camera(pose: LimbPose, passed: float) -> Framing:
    """Around the keeper from the field, with the part of the clip that has passed, 0..1."""
    angle = np.radians(-38.0 + 70.0 * passed)
    middle_m = 0.5 * (pose.point("hips") + pose.point("upperChest"))
    place_m = middle_m + [4.2 * np.sin(angle), 0.40, 4.2 * np.cos(angle)]
    return Framing(place_m, middle_m + [0.0, 0.04, 0.0], 54.0)


class CameraMan:
    """Moves Panda3D's camera smoothly; jumps where the kind of view changes."""

    def __init__(self, base: Any) -> None:
        self._base = base
        self._kind = ""
        self._place = self._target = np.zeros(3)

    def follow(self, shot: Framing, kind: str, dt_s: float) -> None:
        """Once a picture."""
        share = 1.0 if kind != self._kind else 1.0 - float(np.exp(-_FOLLOW_PER_S * dt_s))
        self._kind = kind
        self._place = self._place + share * (shot.place_m - self._place)
        self._target = self._target + share * (shot.target_m - self._target)
        self._base.camera.setPos(*to_panda(self._place).tolist())
        self._base.camera.lookAt(*to_panda(self._target).tolist())
        self._base.camLens.setFov(shot.fov_deg)
        self._base.camLens.setNearFar(0.08, 400.0)
