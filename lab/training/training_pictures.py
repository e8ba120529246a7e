"""Draw pictures of random people with the places of their joints, to train the network of heatmaps on.

python -m lab.training.training_pictures CLIPS OUT --minutes 9 --seed 101

Each file OUT/SEED_NUMBER.npz has pictures (N,128,128,7): what a camera shows about somebody, the same without anybody, both
BGR, and where the person is seen, 0 or 255; uv (N,J,2): the joints in them [px]; farther (N,J): than the hips along the
camera's axis [m, of somebody 1.75 m tall].
A hundred a second and processor; run it once for each processor, with another seed.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import msgspec
import numpy as np

from lab.simulated.motion_clip import MotionClip, read_clip
from lab.simulated.recorded_set import SCENES
from lab.training.random_poses import MovingPose, random_pose
from lab.training.random_scenes import random_body, random_clothes, random_scene
from mocapd.assets import asset_path
from mocapd.body.skeleton import INDEX, joint_positions
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project, to_camera
from mocapd.sim.person.group import PersonBody
from mocapd.sim.person_spec import MotionSpec, PoseKeyframe
from mocapd.sim.renderer import CameraRenderer, figure_of, furnished_set
from mocapd.sim.scenario import Scenario, load_scenario
from mocapd.sim.world import World, light_levels
from mocapd.types import Bytes, Camera, Floats, Pose
from mocapd.vision.heatmaps.joint_network import JOINTS, STATURE_M
from mocapd.vision.heatmaps.person_crop import crop_about, middle_of

PICTURE_PX, SIDE_M = 128, 3.0  # of somebody 1.75 m tall
_SCENES_A_FILE, _PEOPLE_A_SCENE, _POSES, _POSES_A_LIGHT = 4, 3, 24, 8
_BESIDE = 0.2  # share of people behind whom another one stands
_FACES, _FACES_RAD = 0.35, 0.5  # share of people who are turned to the camera, about
_LAID = 0.05  # share of poses that lean over or lie, by up to so much
_LAID_RAD, _THICK_M = 1.7, 0.08
_NEAREST_M = 0.6
_JOINTS = np.array([INDEX[name] for name in JOINTS])
_GREY = (128, 128, 128)


@dataclass(frozen=True, slots=True, eq=False)
class Example:
    """One picture; see above. turns (J,3,3): from each joint's bone, as in the T-pose, to the camera's frame."""

    picture: Bytes
    uv: Floats
    farther: Floats
    turns: Floats


def clips_and_scenes(folder: Path) -> tuple[list[MotionClip], list[Scenario]]:
    """What people do, of this folder of clips, and where."""
    clips = [read_clip(path) for path in sorted(folder.glob("cmu*.npz"))]
    return clips, [load_scenario(asset_path("scenarios") / f"{name}.toml") for name in SCENES]


def examples_of(
    rng: np.random.Generator, scene: Scenario, clips: Sequence[MotionClip]
) -> list[Example]:
    """Of one person in this scene."""
    world, other = (_somebody(rng, scene) for _ in range(2))
    two = rng.uniform() < _BESIDE
    figures = [figure_of(one) for one in ((world, other) if two else (world,))]
    renderer = CameraRenderer(world, figures, furnished_set(scene), 0, samples=1)
    shutter_s = renderer.spec.shutter_s
    out, empty, levels = [], np.zeros(0, np.uint8), np.zeros(0)
    for k in range(_POSES):
        if k % _POSES_A_LIGHT == 0:
            levels = _random_levels(rng, scene)
            empty = renderer.picture(None, levels, int(rng.integers(1 << 20)))
        at_m = rng.normal(0.0, [0.35, 0.0, 0.35])
        pose = random_pose(rng, world.skeleton, clips, shutter_s)
        if rng.uniform() < _FACES:
            pose = _turned_to(rng, renderer.spec.position_m, pose)
        if rng.uniform() < _LAID:
            pose = _laid_down(rng, world, pose)
        pose = _moved(pose, at_m)
        opened, middle, closed = (
            [PersonBody(one)] for one in (pose.opened, pose.middle, pose.closed)
        )
        if two:
            behind = random_pose(rng, other.skeleton, clips, shutter_s)
            behind = _moved(behind, 0.3 * at_m + _behind(rng, renderer.spec.position_m))
            opened.append(PersonBody(behind.opened))
            middle.append(PersonBody(behind.middle))
            closed.append(PersonBody(behind.closed))
        shown = renderer.picture_of_group(opened, closed, levels, int(rng.integers(1 << 20)))
        mask = renderer.mask_of_group(middle)
        example = _example(renderer.camera, (shown, empty, mask), world, pose.middle)
        if example is not None:
            out.append(example)
    return out


def _somebody(rng: np.random.Generator, scene: Scenario) -> World:
    dressed = msgspec.structs.replace(
        scene, body=random_body(rng), clothes=random_clothes(rng), seed=int(rng.integers(1_000_000)),
        motion=MotionSpec(keyframes=[PoseKeyframe(t_s=0.0)]),
    )  # fmt: skip
    return World(dressed)


def _random_levels(rng: np.random.Generator, scene: Scenario) -> Floats:
    levels = light_levels(scene, 0.0)
    if rng.uniform() < 0.5:
        levels = levels * rng.uniform(0.5, 1.1, len(levels))
    if rng.uniform() < 0.15 and len(levels) > 1:
        levels[rng.integers(len(levels))] = 0.0
    return levels


def _behind(rng: np.random.Generator, camera_m: tuple[float, float, float]) -> Floats:
    """From the person away from the camera, and aside."""
    towards = np.array(camera_m) * [1.0, 0.0, 1.0]
    towards /= np.linalg.norm(towards)
    aside = np.array([towards[2], 0.0, -towards[0]])
    out: Floats = aside * rng.uniform(-0.9, 0.9) - towards * rng.uniform(0.9, 1.8)
    return out


def _turned_to(
    rng: np.random.Generator, camera_m: tuple[float, float, float], pose: MovingPose
) -> MovingPose:
    """The hips face the camera, about."""
    x, _, z = camera_m
    ahead = rotations.rotate(pose.middle.quats_xyzw[0], np.array([0.0, 0.0, 1.0]))
    turn_rad = np.arctan2(x, z) - np.arctan2(ahead[0], ahead[2]) + rng.normal(0.0, _FACES_RAD)
    return _turned(pose, np.array([0.0, turn_rad, 0.0]))


def _turned(pose: MovingPose, by_rad: Floats) -> MovingPose:
    """About the hips."""
    turn = rotations.exp(by_rad)
    opened, closed, middle = (
        Pose(one.root_m, rotations.multiply(turn, one.quats_xyzw))
        for one in (pose.opened, pose.closed, pose.middle)
    )
    return MovingPose(opened, closed, middle)


def _laid_down(rng: np.random.Generator, world: World, pose: MovingPose) -> MovingPose:
    """Leaning over to anywhere, as somebody who sits, crawls or lies on the floor."""
    way_rad = rng.uniform(-np.pi, np.pi)
    axis = np.array([np.cos(way_rad), 0.0, np.sin(way_rad)])
    laid = _turned(pose, rng.uniform(0.3, _LAID_RAD) * axis)
    up_m = _THICK_M - joint_positions(world.skeleton, laid.middle)[:, 1].min()
    return _moved(laid, np.array([0.0, up_m, 0.0]))


def _moved(pose: MovingPose, by_m: Floats) -> MovingPose:
    opened, closed, middle = (
        Pose(one.root_m + by_m, one.quats_xyzw) for one in (pose.opened, pose.closed, pose.middle)
    )
    return MovingPose(opened, closed, middle)


def _example(
    camera: Camera, pictures: tuple[Bytes, Bytes, Bytes], world: World, pose: Pose
) -> Example | None:
    """What is about the person, unless that is too near; pictures: with, without anybody, and where the person is."""
    joints_m, quats = joint_positions(world.skeleton, pose), pose.quats_xyzw
    there_m, stature_m = to_camera(camera, joints_m), world.shape.stature_m
    if there_m[:, 2].min() < _NEAREST_M:
        return None
    size = stature_m / STATURE_M
    middle_m = middle_of(there_m[0], there_m[INDEX["neck"]])
    crop = crop_about(camera, middle_m, SIDE_M * size, PICTURE_PX)
    M, square = crop.affine, (PICTURE_PX, PICTURE_PX)
    crops = [
        cv2.warpAffine(one, M, square, flags=cv2.INTER_LINEAR, borderValue=border)
        for one, border in zip(pictures, (_GREY, _GREY, (0,)), strict=True)
    ]
    uv = project(camera, joints_m)[_JOINTS] * crop.scale + crop.corner_px
    farther = (there_m[_JOINTS, 2] - there_m[0, 2]) / size
    turns = camera.R @ rotations.to_matrix(quats[_JOINTS])
    return Example(np.dstack(crops), uv, farther, turns)


def main() -> int:
    """Draw and write."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("clips", type=Path, help="a folder of clips of motion")
    parser.add_argument("out", type=Path)
    parser.add_argument("--minutes", type=float, default=9.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=_SCENES_A_FILE, help="in each file")
    args = parser.parse_args()
    cv2.setNumThreads(1)
    clips, scenes = clips_and_scenes(args.clips)
    args.out.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng(args.seed)
    until_s, number = time.monotonic() + 60.0 * args.minutes, 0
    while number == 0 or time.monotonic() < until_s:
        examples: list[Example] = []
        for _ in range(args.scenes):
            scene = random_scene(rng, scenes)
            for _ in range(_PEOPLE_A_SCENE):
                examples += examples_of(rng, scene, clips)
        path = args.out / f"{args.seed}_{number:04d}.npz"
        partial = path.with_suffix(".partial")
        with partial.open("wb") as file:  # who trains meanwhile reads whole files alone
            np.savez(
                file,
                pictures=np.array([one.picture for one in examples]),
                uv=np.array([one.uv for one in examples], np.float32),
                farther=np.array([one.farther for one in examples], np.float32),
            )
        partial.rename(path)
        number += 1
        sys.stdout.write(f"{number} files\r")
    return 0


if __name__ == "__main__":
    sys.exit(main())
