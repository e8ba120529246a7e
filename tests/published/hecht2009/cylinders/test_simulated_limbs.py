"""Limbs in pictures of the living room: the true pose against poses beside it, and a hand that is followed."""

from dataclasses import dataclass, replace
from functools import cache

import cv2
import numpy as np
import pytest

from mocapd.assets import asset_path
from mocapd.body.skeleton import INDEX
from mocapd.geometry import rotations
from mocapd.published.hecht2009.cylinders.limb_params import (
    LimbMotionParams,
    LimbScoreParams,
)
from mocapd.published.hecht2009.cylinders.limb_particles import start_cloud, step_cloud
from mocapd.published.hecht2009.cylinders.limb_score import LimbView, UsualPenalties
from mocapd.published.hecht2009.cylinders.occlusion import allocate_occlusion, fill_occlusion
from mocapd.published.hecht2009.cylinders.part_colours import (
    AppearanceModel,
    learn,
    observe,
    reference_colours,
)
from mocapd.published.hecht2009.cylinders.work_camera import WorkCamera, work_camera
from mocapd.published.hecht2009.motion_edges import motion_edges, work_picture
from mocapd.sim.renderer import CameraRenderer, camera_renderers
from mocapd.sim.scenario import load_scenario
from mocapd.sim.world import World
from mocapd.types import Bytes, Floats
from tests.published.hecht2009.cylinders.naive import RADII_M, WORK_PX, score_limbs

SCORE = LimbScoreParams()
EDGES_ALONE = replace(SCORE, appearance=False)
LEARNED_S = (0.0, 0.2, 1.3, 1.8, 2.3)  # T-pose and waving
TRIED_S = (1.5, 3.35, 4.0, 4.45, 7.6, 8.1, 8.9, 10.8)
FRAME_S = 1.0 / 30.0
ARMS = {(3, 4): "left", (5, 6): "right"}


@dataclass(frozen=True)
class Stage:
    world: World
    renderers: tuple[CameraRenderer, ...]
    cameras: tuple[WorkCamera, ...]


@cache
def stage() -> Stage:
    world = World(load_scenario(asset_path("scenarios/living_room.toml")))
    renderers = tuple(camera_renderers(world, samples=1))
    return Stage(world, renderers, tuple(work_camera(r.camera, WORK_PX) for r in renderers))


def limb(t_s: float, side: str, of: tuple[str, ...] = ("UpperArm", "LowerArm", "Hand")) -> Floats:
    joints: Floats = stage().world.at(t_s).joints_m
    return joints[[INDEX[side + name] for name in of]]


def body_ends(t_s: float) -> Floats:
    """Ends (11,2,3) of the true body's parts."""
    j = stage().world.at(t_s).joints_m
    up = rotations.rotate(
        stage().world.at(t_s).pose.quats_xyzw[INDEX["head"]], np.array([0, 1.0, 0])
    )
    arms, legs = [limb(t_s, side) for side in ("left", "right")], []
    legs = [limb(t_s, side, ("UpperLeg", "LowerLeg", "Foot")) for side in ("left", "right")]
    waist = 0.5 * (j[INDEX["spine"]] + j[INDEX["chest"]])
    shoulders, hips = 0.5 * (arms[0][0] + arms[1][0]), 0.5 * (legs[0][0] + legs[1][0])
    head = j[INDEX["head"]]
    parts = [(head, head + 0.2 * up), (shoulders, waist), (waist, hips)]
    for points in arms + legs:
        parts += [(points[0], points[1]), (points[1], points[2])]
    return np.array(parts)


@cache
def picture(t_s: float, camera: int) -> tuple[Bytes, Bytes]:
    """Picture (480,640,3) and mask (240,320) of the person."""
    state, renderer = stage().world.at(t_s), stage().renderers[camera]
    pixels = renderer.picture((state.pose, state.pose), state.light_levels, round(1000 * t_s))
    _, mask = renderer.labels(state.pose)
    return pixels, np.asarray(cv2.resize(mask, WORK_PX, interpolation=cv2.INTER_NEAREST), np.uint8)


def seen(t_s: float, camera: int, ends_m: Floats) -> tuple[LimbView, Floats, Floats]:
    """The evidence at t_s, nothing known of colours; quads and depths of the parts."""
    now, before = (work_picture(picture(t, camera)[0], WORK_PX) for t in (t_s, t_s - FRAME_S))
    evidence = motion_edges(now.grey, before.grey)
    occlusion = allocate_occlusion(len(ends_m), WORK_PX, SCORE.cell_px)
    body = fill_occlusion(occlusion, stage().cameras[camera], ends_m, RADII_M)
    unknown = np.full((len(ends_m), SCORE.along, 3), np.nan, np.float32)
    view = LimbView(
        camera,
        stage().cameras[camera],
        now.colour,
        evidence.edges,
        evidence.motion,
        unknown,
        occlusion,
    )
    return view, *body


@cache
def reference() -> tuple[np.ndarray, ...]:
    """The colours of both cameras, learned in the first seconds."""
    model = AppearanceModel.initial(2, len(RADII_M))
    for t_s in LEARNED_S:
        for camera in (0, 1):
            view, quads, depths = seen(t_s, camera, body_ends(t_s))
            mask = picture(t_s, camera)[1]
            rings = observe(quads, depths, view.colour, mask, view.occlusion, SCORE.hidden_by_m)
            model = learn(model, camera, rings, np.ones((len(RADII_M), 2)), 0.1)
    return tuple(reference_colours(model, SCORE.along))


def views_at(t_s: float, ends_m: Floats) -> list[LimbView]:
    views = [seen(t_s, camera, ends_m)[0] for camera in (0, 1)]
    return [replace(view, reference=reference()[view.index]) for view in views]


def beside(arm_m: Floats, by_m: float, rng: np.random.Generator) -> Floats:
    """The arm turned about its shoulder, or its forearm about the elbow, so that the wrist is so far off."""
    pivot = int(rng.integers(0, 2))
    lever = arm_m[2] - arm_m[pivot]
    axis = np.cross(lever, rng.normal(size=3))
    length = float(np.linalg.norm(lever))
    turn = 2.0 * np.arcsin(min(0.5 * by_m / length, 1.0)) * axis / np.linalg.norm(axis)
    out = arm_m.copy()
    out[pivot:] = arm_m[pivot] + rotations.rotate(rotations.exp(turn), arm_m[pivot:] - arm_m[pivot])
    return out


@pytest.mark.parametrize(
    ("params", "by_m", "least"),
    [
        (SCORE, 0.05, 0.95), (SCORE, 0.1, 0.95), (SCORE, 0.2, 0.95),
        (EDGES_ALONE, 0.1, 0.8), (EDGES_ALONE, 0.2, 0.9),
    ],
)  # fmt: skip
def test_the_true_pose_scores_higher_than_poses_beside_it(
    params: LimbScoreParams, by_m: float, least: float
) -> None:
    rng = np.random.default_rng(1)
    usual = UsualPenalties.initial(2, params)
    higher = []
    for t_s in TRIED_S:
        views = views_at(t_s, body_ends(t_s))
        for parts, side in ARMS.items():
            arm = limb(t_s, side)
            tried = np.array([arm] + [beside(arm, by_m, rng) for _ in range(60)])
            scores = score_limbs(tried, RADII_M[list(parts)], parts, views, usual, params)
            higher.append(np.mean(scores[0] > scores[1:]))
    assert np.mean(higher) > least


def test_colours_of_another_arm_are_worse() -> None:
    """What the surface says is of this arm, not of any."""
    t_s, parts = 3.35, (3, 4)
    views = views_at(t_s, body_ends(t_s))
    swapped = [
        replace(view, reference=np.roll(view.reference, 1, axis=1)[:, :, ::-1].copy())
        for view in views
    ]
    arm = limb(t_s, "left")[None]
    usual = UsualPenalties.initial(2, SCORE)
    own, other = (
        score_limbs(arm, RADII_M[list(parts)], parts, of, usual, SCORE)[0]
        for of in (views, swapped)
    )
    assert own > other + 5.0


def test_a_waving_hand_is_followed() -> None:
    parts, side = (5, 6), "right"
    rng, errors = np.random.default_rng(3), []
    cloud = start_cloud(limb(1.5, side), 200, 2, SCORE)
    lengths = np.linalg.norm(np.diff(limb(1.5, side), axis=0), axis=1)
    for i in range(1, 25):
        t_s = 1.5 + i * FRAME_S
        ends = body_ends(t_s)
        shoulder = ends[parts[0], 0]
        ends[parts[0]], ends[parts[1]] = cloud.mean_m[:2], cloud.mean_m[1:]

        def hang_together(points: Floats, shoulder: Floats = shoulder) -> Floats:
            out = points.copy()
            out[:, 0] = shoulder
            for k in (0, 1):
                way = out[:, k + 1] - out[:, k]
                out[:, k + 1] = out[:, k] + lengths[k] * way / np.linalg.norm(way, axis=1)[:, None]
            return out

        cloud = step_cloud(
            cloud, FRAME_S, RADII_M[list(parts)], parts, views_at(t_s, ends), hang_together, rng,
            LimbMotionParams(), SCORE,
        )  # fmt: skip
        errors.append(np.linalg.norm(cloud.mean_m - limb(t_s, side), axis=1)[1:])
    assert np.median(errors) < 0.06
    assert np.max(errors) < 0.25
