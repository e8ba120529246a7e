"""Learning where arms are, from clips whose arms are known."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np

from lab.training.train_arm_motion import mean_rotation
from mocapd.body.bones import NAMES
from mocapd.body.skeleton import INDEX, standard_skeleton
from mocapd.geometry import rotations
from mocapd.types import Floats

FRAMES, RATE_HZ = 400, 60.0
HANGING = np.array([0.0, -0.3, -1.1])


def clip(folder: Path, name: str, swing_rad: float) -> None:
    """Arms that hang and swing forwards and back, the left and the right one alike."""
    t_s = np.arange(FRAMES) / RATE_HZ
    swing = rotations.exp(swing_rad * np.sin(4.0 * t_s)[:, None] * np.array([1.0, 0.0, 0.0]))
    quats = np.tile(rotations.IDENTITY_XYZW, (FRAMES, len(NAMES), 1))
    for side, signs in (("left", [1.0, 1.0, 1.0]), ("right", [1.0, -1.0, -1.0])):
        arm = rotations.multiply(swing, rotations.exp(HANGING * signs))
        for bone in ("UpperArm", "LowerArm", "Hand"):
            quats[:, INDEX[side + bone]] = arm
    rest: Floats = standard_skeleton(1.7).rest_m
    np.savez(
        folder / f"{name}.npz", fps=RATE_HZ, names=list(NAMES), rest_offsets=rest * 0.0 + 0.1, global_quats=quats,
        hips_pos=np.tile(rest[0], (FRAMES, 1)),
    )  # fmt: skip


def test_a_mean_rotation_is_least_away() -> None:
    rng = np.random.default_rng(0)
    true = rotations.exp(np.array([0.3, -1.2, 0.8]))
    samples = rotations.multiply(rotations.exp(rng.normal(0.0, 0.2, (4000, 3))), true)
    mean = mean_rotation(samples, np.full(4000, 1 / 4000))
    assert rotations.angle_rad(mean, true) < 0.02


def test_mean_and_spread_of_clips_are_written(tmp_path: Path) -> None:
    for n, swing_rad in enumerate((0.3, 0.5)):
        clip(tmp_path, f"clip{n}", swing_rad)
    out = tmp_path / "arm_motion.json"
    told = subprocess.run(
        [sys.executable, "-m", "lab.training.train_arm_motion", str(tmp_path), str(out)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert told.stdout.startswith("2 clips")
    trained = json.loads(out.read_text())
    upper = np.array(trained["mean_xyzw"][1])
    assert rotations.angle_rad(upper, rotations.exp(HANGING)) < 0.05
    sd = np.sqrt(np.diag(trained["covariance_rad2"]))
    # of a sine, and what is added for what clips do not tell
    assert abs(sd[3] - np.sqrt(0.5 * (0.09 + 0.25) / 2 + 0.04)) < 0.02
    assert sd[4] < 0.25
    assert sd[7:].max() < 0.3  # the elbow is stiff, its twist is not believed
