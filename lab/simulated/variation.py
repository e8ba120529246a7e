"""How sessions differ from each other: bodies, clothes, lights, and pairs of cameras side by side."""

from typing import Any, Literal

import msgspec
import numpy as np

from mocapd.sim.person_spec import BodySpec, Clothes, Weave
from mocapd.sim.scenario import CameraSpec, Light, LightEvent, Scenario
from mocapd.sim.scenario_values import Srgb

Pattern = Literal["plain", "stripes", "checks", "print"]
_PEOPLE: tuple[tuple[Srgb, Srgb], ...] = (  # skin, hair
    ((198, 152, 124), (66, 46, 34)),
    ((222, 178, 152), (140, 104, 60)),
    ((128, 86, 62), (28, 24, 24)),
    ((172, 122, 92), (36, 30, 28)),
    ((96, 64, 48), (24, 20, 20)),
    ((226, 186, 164), (112, 108, 104)),
)


class Variation:
    """Factors about 1, drawn one after the other."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.rng = rng

    def __call__(self, spread: float) -> float:
        return float(np.clip(self.rng.normal(1.0, spread), 0.88, 1.14))


def varied_body(vary: Variation, **more: Any) -> BodySpec:
    """Somebody of any stature."""
    return BodySpec(
        stature_m=round(float(vary.rng.uniform(1.55, 1.92)), 3),
        torso_length=vary(0.03), shoulder_width=vary(0.05), upper_arm_length=vary(0.04),
        forearm_length=vary(0.04), torso_width=vary(0.06), torso_depth=vary(0.06), arm_girth=vary(0.08), **more,
    )  # fmt: skip


def varied_lights(scene: Scenario, vary: Variation, first_off_s: float | None) -> tuple[Light, ...]:
    """The scene's lights, each a little brighter or darker. first_off_s: when the first goes out, if it does."""
    off = () if first_off_s is None else (LightEvent(t_s=first_off_s, level=0.0, over_s=0.05),)
    return tuple(
        msgspec.structs.replace(
            light, intensity=light.intensity * vary(0.1), events=off if i == 0 else ()
        )
        for i, light in enumerate(scene.lights)
    )


def varied_clothes(vary: Variation, number: int) -> Clothes:
    """Plain ones in any colours, some of them striped, checked or printed, some with short sleeves."""
    tops: tuple[Pattern, ...] = ("plain", "stripes", "print", "plain", "checks")
    trousers: tuple[Pattern, ...] = ("plain", "plain", "stripes", "plain")
    skin, hair = _PEOPLE[int(vary.rng.integers(len(_PEOPLE)))]
    return Clothes(
        shirt="plain",
        wrinkles_m=float(vary.rng.uniform(0.005, 0.008)),
        top_srgb=_cloth(vary.rng, 70, 215),
        top_weave=Weave(
            pattern=tops[number % 5],
            srgb=_cloth(vary.rng, 60, 240),
            period_m=0.05 + 0.05 * float(vary.rng.uniform()),
        ),
        sleeves="short" if number % 3 == 2 else "long",
        trousers_srgb=_cloth(vary.rng, 40, 130),
        trousers_weave=Weave(
            pattern=trousers[number % 4], srgb=_cloth(vary.rng, 60, 200), period_m=0.035
        ),
        skin_srgb=skin,
        hair_srgb=hair,
        shoes_srgb=_cloth(vary.rng, 30, 220),
    )


def _cloth(rng: np.random.Generator, low: int, high: int) -> Srgb:
    """A muted colour of a brightness between two sRGB values."""
    grey = rng.uniform(low, high)
    tint = rng.normal(size=3)
    values = np.clip(grey + 0.30 * grey * (tint - tint.mean()), 12, 245).astype(int)
    return int(values[0]), int(values[1]), int(values[2])


def stereo_pair(middle: CameraSpec, apart_m: float = 0.12) -> list[CameraSpec]:
    """Two cameras cam0, cam1 side by side, looking the same way and exposing together, left and right of one."""
    along = np.array(middle.look_at_m) - middle.position_m
    right = np.cross(along, [0.0, 1.0, 0.0])
    right *= 0.5 * apart_m / np.linalg.norm(right)
    out = []
    for k, side in enumerate((-1.0, 1.0)):
        position, look_at = (
            np.array(place) + side * right for place in (middle.position_m, middle.look_at_m)
        )
        out.append(
            msgspec.structs.replace(
                middle, name=f"cam{k}", clock_offset_s=0.0,
                position_m=(float(position[0]), float(position[1]), float(position[2])),
                look_at_m=(float(look_at[0]), float(look_at[1]), float(look_at[2])),
            )
        )  # fmt: skip
    return out
