"""The scenario's lights as arrays for the kernels."""

from typing import NamedTuple

import numpy as np

from mocapd.sim.scenario import Scenario
from mocapd.types import Floats, Ints


class Lamps(NamedTuple):
    """L lights: at_m (L,3) (a unit direction when sun), rgb (L,3) linear at 1 m, radius_m (L,), sun (L,) 0/1."""

    at_m: Floats
    rgb: Floats
    radius_m: Floats
    sun: Ints
    ambient_up: Floats
    ambient_down: Floats


def lamps_of(scenario: Scenario) -> Lamps:
    """The lights of a scenario at level 1."""
    lights = scenario.lights
    at = np.array([light.position_m for light in lights]).reshape(-1, 3)
    sun = np.array([int(light.sun) for light in lights], dtype=np.int64)
    length = np.linalg.norm(at, axis=1, keepdims=True)
    rgb = np.array([light.colour for light in lights]).reshape(-1, 3)
    return Lamps(
        at_m=np.where(sun[:, None] > 0, at / np.maximum(length, 1e-9), at),
        rgb=rgb * np.array([light.intensity for light in lights]).reshape(-1, 1),
        radius_m=np.array([light.radius_m for light in lights]),
        sun=sun,
        ambient_up=np.array(scenario.ambient.up),
        ambient_down=np.array(scenario.ambient.down),
    )


def studio_lamps() -> Lamps:
    """Neutral light for the pictures of the shirt: a large key light, a fill light, white ambient."""
    return Lamps(
        at_m=np.array([[-1.6, 2.6, 2.6], [2.2, 2.2, 2.4]]),
        rgb=np.array([[5.2] * 3, [3.2] * 3]),
        radius_m=np.array([0.3, 0.3]),
        sun=np.zeros(2, dtype=np.int64),
        ambient_up=np.full(3, 0.34),
        ambient_down=np.full(3, 0.24),
    )
