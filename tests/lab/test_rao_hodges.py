"""The experiment of Rao and Hodges runs on clips and prints its tables."""

import os
from pathlib import Path

import numpy as np
import pytest

from mocapd.body.bones import NAMES
from mocapd.body.skeleton import PARENTS, standard_skeleton
from mocapd.geometry import rotations
from tests.lab.lab_process import lab

pytestmark = pytest.mark.kernels


def swinging_clip(path: Path, rate: float) -> None:
    """A clip of motion in which all limbs swing."""
    skeleton, frames = standard_skeleton(1.75), 8
    swing = np.sin(rate * np.arange(frames))[:, None] * np.linspace(0.05, 0.2, len(NAMES))
    quats = rotations.exp(swing[..., None] * np.array([1.0, 0.2, 0.1]))
    offsets = skeleton.rest_m - skeleton.rest_m[np.maximum(PARENTS, 0)]
    np.savez(
        path, fps=60.0, names=np.array(NAMES), rest_offsets=offsets, global_quats=quats,
        hips_pos=np.tile(skeleton.rest_m[0], (frames, 1)),
    )  # fmt: skip


def test_tables_of_two_clips_and_an_error_for_one(tmp_path: Path) -> None:
    swinging_clip(tmp_path / "a.npz", 0.2)
    env = dict(os.environ)
    alone = lab(env, "rao_hodges", tmp_path)
    assert alone.code == 66
    assert "fewer than two clips" in alone.err
    swinging_clip(tmp_path / "b.npz", 0.3)
    done = lab(env, "rao_hodges", tmp_path)
    assert done.code == 0, done.err
    for label in ("as published: legs", "with the converse term", "2D weight", "crossover", "PCA"):
        assert f"| {label} |" in done.out
    learned = lab(env, "rao_hodges.learn_motion", tmp_path)
    assert "| knee_x |" in learned.out
