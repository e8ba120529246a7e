"""Random people to train on: they stand on the floor in poses that bodies have, and their joints are where they are drawn."""

import subprocess
import sys
from pathlib import Path

import numpy as np

from lab.simulated.motion_clip import read_clip
from lab.training.keypoint_marks import marks
from lab.training.random_poses import random_pose
from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.geometry import rotations
from mocapd.vision.heatmaps.joint_network import JOINTS, MARKS, STATURE_M
from tests.lab.test_train_arm_motion import clip


def test_people_stand_on_the_floor_or_just_above_it(tmp_path: Path) -> None:
    clip(tmp_path, "cmu_arms", 0.4)
    clips, skeleton = [read_clip(tmp_path / "cmu_arms.npz")], standard_skeleton(1.75)
    rng = np.random.default_rng(4)
    faces, lowest_m = [], []
    for _ in range(60):
        pose = random_pose(rng, skeleton, clips, 0.02)
        joints_m = joint_positions(skeleton, pose.opened)
        feet = [INDEX[side + joint] for side in ("left", "right") for joint in ("Foot", "Toes")]
        lowest_m.append((joints_m - skeleton.rest_m)[feet, 1].min())
        across = joints_m[INDEX["leftUpperLeg"]] - joints_m[INDEX["rightUpperLeg"]]
        faces.append(np.arctan2(across[2], across[0]))
        away_m = joint_positions(skeleton, pose.closed) - joints_m
        assert np.linalg.norm(away_m, axis=1).max() < 0.6  # nobody moves as fast as that
    assert min(lowest_m) > -0.03
    assert max(lowest_m) < 0.3
    assert max(faces) - min(faces) > 5.0  # all the way round


def test_joints_are_on_somebody_who_was_not_in_the_empty_picture(tmp_path: Path) -> None:
    clip(tmp_path, "cmu_arms", 0.4)
    subprocess.run(
        [sys.executable, "-m", "lab.training.training_pictures", str(tmp_path), str(tmp_path / "out"),
         "--minutes", "0", "--scenes", "1", "--seed", "3"], check=True, capture_output=True,
    )  # fmt: skip
    (path,) = (tmp_path / "out").glob("*.npz")
    with np.load(path) as data:
        pictures, uv, farther = data["pictures"], data["uv"], data["farther"]
    assert len(pictures) > 50
    assert farther.shape == (len(pictures), len(JOINTS))
    off = np.abs(pictures[..., :3].astype(int) - pictures[..., 3:6]).max(axis=-1)
    at = np.rint(uv[:, [JOINTS.index("hips"), JOINTS.index("neck")]]).astype(int).clip(0, 127)
    on_body = off[np.arange(len(off))[:, None], at[..., 1], at[..., 0]]
    assert np.median(on_body) > 2.0 * np.median(off)
    assert (on_body > 8).mean() > 0.8
    mask = pictures[..., 6] > 127
    assert mask[np.arange(len(off))[:, None], at[..., 1], at[..., 0]].mean() > 0.9
    assert np.median(off[mask]) > 2.0 * np.median(off[~mask])


def test_marks_beside_joints_are_found_among_outliers() -> None:
    """`MARKS` are what explains how far beside the joints the network marks them, in pictures from all sides."""
    rng = np.random.default_rng(5)
    n, j = 600, len(JOINTS)
    turns = rotations.to_matrix(rotations.exp(rng.normal(0.0, 1.5, (n, j, 3))))
    spread_m = rng.uniform(0.03, 0.10, (n, j))
    off_m = np.einsum("njab,jb->nja", turns[:, :, :2], MARKS * STATURE_M)
    off_m += 0.5 * spread_m[..., None] * rng.normal(size=(n, j, 2))
    off_m[rng.uniform(size=(n, j)) < 0.1] += 0.4  # the other hand
    np.testing.assert_allclose(marks(off_m, spread_m, turns), MARKS, atol=0.003)
