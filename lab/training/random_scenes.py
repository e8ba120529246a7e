"""Rooms of any colours with things about, a camera anywhere in them, and people in any clothes."""

from collections.abc import Sequence
from typing import Literal, get_args

import msgspec
import numpy as np

from lab.simulated.session_plan import is_wide
from lab.simulated.variation import Variation, varied_body, varied_clothes
from mocapd.sim.person_spec import BodySpec, Clothes
from mocapd.sim.scenario import CameraSpec, Scenario, SurfaceSpec, Thing
from mocapd.sim.scenario_values import Srgb

SIZE_PX = (320, 240)  # of work pictures
_Pattern = Literal["plain", "plaster", "planks", "checks", "grass", "bricks"]
_Kind = Literal["box", "ball", "bookshelf", "table", "tree", "sofa"]
_KINDS: tuple[_Kind, ...] = get_args(_Kind)
_PATTERNS: tuple[_Pattern, ...] = get_args(_Pattern)
_CLEAR_M = 1.2  # between camera and person no thing stands nearer to the way


def random_scene(rng: np.random.Generator, scenes: Sequence[Scenario]) -> Scenario:
    """One of the scenes with other colours, things and lights, before one camera of work size."""
    scene = scenes[int(rng.integers(len(scenes)))]
    camera: CameraSpec = _camera(rng, scene)
    room = scene.room
    if rng.uniform() < 0.7:
        room = msgspec.structs.replace(room, walls=_surface(rng, 235.0))
    if rng.uniform() < 0.6:
        room = msgspec.structs.replace(room, floor=_surface(rng, 190.0))
    room = msgspec.structs.replace(room, things=(*room.things, *_things(rng, camera)))
    lights = tuple(
        msgspec.structs.replace(one, intensity=one.intensity * rng.uniform(0.5, 1.4), events=())
        for one in scene.lights
    )
    return msgspec.structs.replace(
        scene, cameras=[camera], room=room, lights=lights, others=(), absences=(),
        seed=int(rng.integers(1_000_000)),
    )  # fmt: skip


def random_body(rng: np.random.Generator) -> BodySpec:
    """Somebody of any build."""
    vary = Variation(rng)
    return varied_body(
        vary, whole=True, thigh_length=vary(0.02), shank_length=vary(0.02), hip_width=vary(0.04),
        leg_girth=vary(0.08), head_size=vary(0.03),
    )  # fmt: skip


def random_clothes(rng: np.random.Generator) -> Clothes:
    """Plain ones, or the shirt of coloured patches; now and then all of one colour."""
    clothes = varied_clothes(Variation(rng), int(rng.integers(60)))
    if rng.uniform() < 0.18:
        clothes = msgspec.structs.replace(clothes, shirt="standard-v1")
    if rng.uniform() < 0.5:
        clothes = msgspec.structs.replace(clothes, top_srgb=_colour(rng, 20.0, 235.0))
    if rng.uniform() < 0.5:
        clothes = msgspec.structs.replace(clothes, trousers_srgb=_colour(rng, 20.0, 200.0))
    if rng.uniform() < 0.08:
        clothes = msgspec.structs.replace(clothes, trousers_srgb=clothes.top_srgb)
    return clothes


def _camera(rng: np.random.Generator, scene: Scenario) -> CameraSpec:
    if is_wide(scene):
        azimuth_rad, away_m = rng.uniform(-np.pi, np.pi), rng.uniform(2.3, 4.2)
    else:
        azimuth_rad, away_m = rng.normal(0.0, 0.5), rng.uniform(2.2, 3.4)
    seen = scene.cameras[0]
    at_m = (away_m * np.sin(azimuth_rad), rng.uniform(0.7, 2.1), away_m * np.cos(azimuth_rad))
    looks_at_m = rng.normal([0.0, 1.0, 0.0], [0.25, 0.12, 0.25]).tolist()
    return msgspec.structs.replace(
        seen, size_px=SIZE_PX, focal_px=None, centre_px=None, dist=(0.0,) * 5, fov_deg=rng.uniform(50.0, 70.0),
        position_m=tuple(map(float, at_m)), look_at_m=tuple(looks_at_m), roll_deg=rng.normal(0.0, 1.5),
        shutter_s=rng.uniform(0.004, 0.022), gain=seen.gain * rng.uniform(0.55, 1.35),
        white_balance=tuple(rng.uniform(0.85, 1.15, 3).tolist()), shot_noise=rng.uniform(0.004, 0.014),
        read_noise=rng.uniform(0.001, 0.004),
    )  # fmt: skip


def _things(rng: np.random.Generator, camera: CameraSpec) -> list[Thing]:
    """What stands about, but not before the camera."""
    before = 0.55 * np.array(camera.position_m)[[0, 2]]
    out = []
    for _ in range(rng.integers(0, 5)):
        azimuth_rad, away_m = rng.uniform(-np.pi, np.pi), rng.uniform(1.1, 2.6)
        x, z = float(away_m * np.sin(azimuth_rad)), float(away_m * np.cos(azimuth_rad))
        size = rng.uniform(0.3, 1.2, 3).tolist()
        kind = _KINDS[rng.integers(len(_KINDS))]
        if np.hypot(x - before[0], z - before[1]) < _CLEAR_M:
            continue
        out.append(
            Thing(
                kind=kind, base_m=(x, 0.0, z), size_m=tuple(size), yaw_deg=rng.uniform(0.0, 360.0),
                srgb=_colour(rng, 30.0, 235.0), pattern=_pattern(rng) if kind == "box" else "plain",
            )
        )  # fmt: skip
    return out


def _surface(rng: np.random.Generator, brightest: float) -> SurfaceSpec:
    return SurfaceSpec(srgb=_colour(rng, 30.0, brightest), pattern=_pattern(rng))


def _pattern(rng: np.random.Generator) -> _Pattern:
    return _PATTERNS[rng.integers(len(_PATTERNS))]


def _colour(rng: np.random.Generator, low: float, high: float) -> Srgb:
    grey = rng.uniform(low, high)
    tint = rng.normal(size=3)
    r, g, b = np.clip(grey + 0.3 * grey * (tint - tint.mean()), 10, 245).astype(int).tolist()
    return r, g, b
