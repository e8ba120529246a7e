"""Measures the pose database: dispersion against random sampling, recall and cost of the index.

    python -m lab.measure_database CACHE_DIR [--queries 200]

Queries are held-out random poses of the same generator, and as many picked farthest apart out of ten
times their number: dispersion is about the rare views too. Prints the tables of
docs/decisions/pose-database.md.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mocapd.body.model import build_model
from mocapd.body.skeleton import INDEX, joint_positions, standard_skeleton
from mocapd.geometry import rotations
from mocapd.shirt.pose_database.database import DatabaseParams, PoseDatabase, render
from mocapd.shirt.pose_database.database_file import load_or_build
from mocapd.shirt.pose_database.idmap_crop_kernels import SIZE, unpack
from mocapd.shirt.pose_database.idmap_index import nearest_exact
from mocapd.shirt.pose_database.pose_sampling import PoseSet, poses_from_cube, random_cube
from mocapd.types import Bytes, Floats, Ints, Pose

K = 10
_JOINTS = [
    INDEX[side + bone]
    for side in ("left", "right")
    for bone in ("UpperArm", "LowerArm", "Hand")
]  # fmt: skip
_SETTINGS = ((12, 40), (24, 60), (24, 80), (40, 80), (40, 120), (80, 200), (512, 400))


def random_poses(count: int, seed: int, params: DatabaseParams) -> PoseSet:
    """`count` independent random poses of the generator."""
    parts: list[PoseSet] = []
    while sum(len(part) for part in parts) < count:
        parts.append(poses_from_cube(random_cube(2048, seed + 7919 * len(parts)), params.sampling))
    return PoseSet(
        np.concatenate([part.local_xyzw for part in parts])[:count],
        np.concatenate([part.camera_from_root_xyzw for part in parts])[:count],
    )


def exact_neighbours(queries: Bytes, maps: Bytes) -> tuple[Ints, NDArray[np.float64]]:
    """Indices (Q,K) and distances (Q,K) by comparing each packed query with every packed map."""
    everything = np.arange(len(maps))
    best = np.empty((len(queries), K), np.int64)
    distance = np.empty((len(queries), K))
    id_map = np.empty((SIZE, SIZE), np.uint8)
    for i, packed in enumerate(queries):
        unpack(packed, id_map)
        nearest_exact(id_map, maps, everything, best[i], distance[i])
    return best, distance


def arm_joints(local_xyzw: Floats, camera_from_root_xyzw: Floats, stature_m: float) -> Floats:
    """Shoulders, elbows and wrists (6,3) in the camera's frame, from the hips [m]."""
    skeleton = standard_skeleton(stature_m)
    local = np.array(local_xyzw, dtype=float)
    local[0] = camera_from_root_xyzw
    turned = local.copy()
    for j in range(1, len(local)):
        turned[j] = rotations.multiply(turned[skeleton.parents[j]], local[j])
    return joint_positions(skeleton, Pose(np.zeros(3), turned))[_JOINTS]


def pose_errors(queries: PoseSet, poses: PoseSet, best: Ints, stature_m: float) -> Floats:
    """RMS distance (Q,) of the arms' joints between each query and its nearest neighbour [m]."""
    errors = np.empty(len(queries))
    for i, n in enumerate(best[:, 0]):
        a = arm_joints(queries.local_xyzw[i], queries.camera_from_root_xyzw[i], stature_m)
        b = arm_joints(poses.local_xyzw[n], poses.camera_from_root_xyzw[n], stature_m)
        errors[i] = np.sqrt(((a - b) ** 2).sum(axis=1).mean())
    return errors


def farthest_apart(maps: Bytes, count: int, database: PoseDatabase) -> Ints:
    """Indices (count,) of the packed maps that lie farthest apart, by the database's own vectors: from the one nearest
    to the mean on, always the one that is farthest from all before."""
    vectors = database.index.projection.vectors(maps)
    chosen = [int(((vectors - vectors.mean(axis=0)) ** 2).sum(axis=1).argmin())]
    gap = np.full(len(vectors), np.inf)
    while len(chosen) < count:
        gap = np.minimum(gap, ((vectors - vectors[chosen[-1]]) ** 2).sum(axis=1))
        chosen.append(int(gap.argmax()))
    return np.array(chosen)


def dispersion_row(name: str, distance: NDArray[np.float64], errors: Floats) -> str:
    """One line of the dispersion table."""
    return (
        f"| {name} | {distance[:, 0].mean():.2f} | {np.quantile(distance[:, 0], 0.95):.2f} "
        f"| {distance[:, 0].max():.1f} | {distance.mean():.2f} | {100 * errors.mean():.1f} "
        f"| {100 * np.quantile(errors, 0.95):.1f} |"
    )


def recall_row(
    database: PoseDatabase, queries: Bytes, truth: Ints, setting: tuple[int, int]
) -> str:
    """One line of the recall table for a setting (probes, reranked)."""
    id_map = np.empty((SIZE, SIZE), np.uint8)
    found, first = [], []
    for packed, wanted in zip(queries, truth, strict=True):
        unpack(packed, id_map)
        got, _ = database.nearest(id_map, K, *setting)
        found.append(len(set(got.tolist()) & set(wanted.tolist())) / K)
        first.append(float(got[0] == wanted[0]))
    return (
        f"| {setting[0]} | {setting[1]} | {np.mean(found):.3f} | {np.mean(first):.3f} "
        f"| {np.quantile(found, 0.05):.2f} |"
    )


def _poses(database: PoseDatabase) -> PoseSet:
    return PoseSet(database.local_xyzw, database.camera_from_root_xyzw)


def main() -> int:
    """Print both tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("cache_dir", type=Path)
    parser.add_argument("--queries", type=int, default=200)
    arguments = parser.parse_args()
    params = DatabaseParams()
    database = load_or_build(arguments.cache_dir, params).database
    model = build_model(params.stature_m)
    n = arguments.queries
    held_out = random_poses(10 * n, 1_000_003, params)
    maps = render(held_out, model, params, lambda _: None).packed_maps
    sets = {"random": np.arange(n), "far apart": farthest_apart(maps, n, database)}

    say = sys.stdout.write
    say("| poses | queries | nearest, mean [px²] | 95 % | worst | ten nearest, mean |")
    say(" arm joints [cm] | 95 % |\n|---|---|---|---|---|---|---|---|\n")
    drawn = random_poses(params.count, 5, params)
    made: dict[str, tuple[PoseSet, Bytes]] = {
        "random": (drawn, render(drawn, model, params, lambda _: None).packed_maps),
        "Sobol (ours)": (_poses(database), database.index.packed_maps),
    }
    for name, (poses, packed) in made.items():
        for kind, picked in sets.items():
            best, distance = exact_neighbours(maps[picked], packed)
            asked = PoseSet(held_out.local_xyzw[picked], held_out.camera_from_root_xyzw[picked])
            errors = pose_errors(asked, poses, best, params.stature_m)
            say(dispersion_row(f"{name} | {kind}", distance, errors) + "\n")
    queries = maps[:n]
    best, _ = exact_neighbours(queries, database.index.packed_maps)
    say("\n| cells probed | re-ranked | recall@10 | nearest found | recall@10, worst 5 % |\n")
    say("|---|---|---|---|---|\n")
    for setting in _SETTINGS:
        say(recall_row(database, queries, best, setting) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
