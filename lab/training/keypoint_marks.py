"""Measure where the trained network marks each joint, in its bone's own frame: `MARKS` of vision/heatmaps/joint_network.py.

python -m lab.training.keypoint_marks CLIPS --pictures 6000

What the network learned is held by flesh, which turns otherwise than bones, and means of maps fall short of the ends of
limbs. Random people are drawn; the offset that explains what is off in all pictures is found by robust least squares (each
picture tells two of its three components).
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import cv2
import numpy as np

from lab.training.random_scenes import random_scene
from lab.training.training_pictures import PICTURE_PX, Example, clips_and_scenes, examples_of
from lab.training.training_pictures import SIDE_M as PICTURE_M
from mocapd.body.bones import NAMES
from mocapd.body.skeleton import INDEX, OTHER_SIDE
from mocapd.types import Floats
from mocapd.vision.heatmaps.joint_network import (
    CELLS,
    INPUT_PX,
    JOINTS,
    SIDE_M,
    STATURE_M,
    JointNetwork,
)

_TYPICAL_M = 0.04  # what is farther off weighs less
_ITERATIONS = 20


def marked_off_m(network: JointNetwork, example: Example) -> tuple[Floats, Floats]:
    """How far beside each joint it is marked (J,2) [m, of somebody of STATURE_M], and the spread (J,) of its map [m]."""
    scale = INPUT_PX / PICTURE_PX * PICTURE_M / SIDE_M
    shift = (INPUT_PX - 1) / 2 - scale * (PICTURE_PX - 1) / 2
    M = np.array([[scale, 0.0, shift], [0.0, scale, shift]])
    cut = cv2.warpAffine(example.picture[..., :3], M, (INPUT_PX, INPUT_PX))
    room = cv2.warpAffine(example.picture[..., 3:6], M, (INPUT_PX, INPUT_PX)).astype(np.float32)
    everywhere = np.ones((INPUT_PX, INPUT_PX), np.uint8)
    found = network.detect(np.asarray(cut, np.uint8), room, everywhere)
    cell_px = INPUT_PX / CELLS
    true_cells = (example.uv * scale + shift - (cell_px / 2 - 0.5)) / cell_px
    spread_m = np.sqrt(found.spread_cells2[:, [0, 2]].sum(axis=1)) * SIDE_M / CELLS
    return (found.at_cells - true_cells) * SIDE_M / CELLS, spread_m


def marks(off_m: Floats, spread_m: Floats, turns: Floats) -> Floats:
    """The offset (J,3) of each joint in its bone's frame [statures] that explains off_m (N,J,2) best, of joints with maps of
    spread_m (N,J), in bones turned by turns (N,J,3,3); left and right mirrored."""
    rows = turns[:, :, :2]
    found = np.zeros((len(JOINTS), 3))
    for _ in range(_ITERATIONS):
        left_m = off_m - np.einsum("njab,jb->nja", rows, found)
        m2 = np.sum(left_m**2, axis=2) / (_TYPICAL_M**2 + spread_m**2)
        weight = 1.0 / ((1.0 + m2) ** 2 * (_TYPICAL_M**2 + spread_m**2))
        A = np.einsum("nj,njab,njac->jbc", weight, rows, rows)
        b = np.einsum("nj,njab,nja->jb", weight, rows, off_m)
        found = np.linalg.solve(A, b[..., None])[..., 0]
    other = [JOINTS.index(NAMES[OTHER_SIDE[INDEX[name]]]) for name in JOINTS]
    symmetric: Floats = 0.5 * (found + found[other] * [-1.0, 1.0, 1.0])
    return symmetric / STATURE_M


def main(argv: Sequence[str] | None = None) -> int:
    """Draw, look, print."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("clips", type=Path, help="a folder of clips of motion")
    parser.add_argument("--pictures", type=int, default=6000)
    parser.add_argument("--seed", type=int, default=7)
    args = parser.parse_args(argv)
    cv2.setNumThreads(1)
    clips, scenes = clips_and_scenes(args.clips)
    rng, network = np.random.default_rng(args.seed), JointNetwork()
    off_m, spread_m, turns = list[Floats](), list[Floats](), list[Floats]()
    while len(off_m) < args.pictures:
        for example in examples_of(rng, random_scene(rng, scenes), clips):
            off, spread = marked_off_m(network, example)
            off_m.append(off)
            spread_m.append(spread)
            turns.append(example.turns)
        sys.stderr.write(f"{len(off_m)} of {args.pictures} pictures\r")
    for name, (x, y, z) in zip(
        JOINTS, marks(*map(np.array, (off_m, spread_m, turns))), strict=True
    ):
        if not name.startswith("right"):
            print(f"{name.removeprefix('left'):10} {x:7.4f} {y:7.4f} {z:7.4f}")  # noqa: T201
    return 0


if __name__ == "__main__":
    sys.exit(main())
