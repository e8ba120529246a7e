"""The pose database: 80,000 upper-body poses with their 40x40 id maps. [Wang 2011, section 5.2, step 2]"""

import hashlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mocapd.body.arrays import plain
from mocapd.body.model import BodyModel, Shaped, build_model
from mocapd.body.skeleton import N_JOINTS
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import normalised
from mocapd.shirt.garment import shirt_labels
from mocapd.shirt.pose_database import idmap_crop_kernels, idmap_index_kernels
from mocapd.shirt.pose_database.idmap_index import (
    PACKED,
    IdMapIndex,
    cluster,
    fit_projection,
    nearest_centre,
)
from mocapd.shirt.pose_database.idmap_render_kernels import CANVAS, RenderedPoses, render_poses
from mocapd.shirt.pose_database.key_poses import ARMS, TORSOS
from mocapd.shirt.pose_database.pose_sampling import (
    LowDispersionCube,
    PoseSet,
    SamplingParams,
    poses_from_cube,
)
from mocapd.types import Bytes, Camera, Floats, Ints, Singles

VERSION = 2  # of what the code makes of the parameters; raise it when that changes
_POWER = 11  # poses are drawn in pieces of 2**11
_CHUNK = 2000
_FITTED = 8000  # poses that the descriptor's axes are fitted to
_LLOYD_ROUNDS = 6

Progress = Callable[[float], None]
MapChunks = Callable[[Callable[[slice], None], Iterable[slice]], Iterable[None]]


@dataclass(frozen=True, slots=True)
class DatabaseParams:
    """How the database is made; all of it enters the content hash."""

    count: int = 80_000
    seed: int = 2011
    stature_m: float = 1.75
    focal_px: float = 650.0
    distance_m: float = 2.8
    dimensions: int = 64  # of the index' vectors
    cells: int = 512
    sampling: SamplingParams = field(default_factory=SamplingParams)


@dataclass(frozen=True, slots=True, eq=False)
class PoseDatabase:
    """N poses and the index over their id maps.

    local_xyzw (N,J,4): rotations relative to the parent bone, the root's being identity.
    camera_from_root_xyzw (N,4): the root's rotation in a camera with its optical axis through the
    person; world_from_root = inverse(camera_from_world) * camera_from_view * this, with
    `camera_from_view` for the direction of the crop's centre.
    root_m (N,3), side_rad (N,): where the root is, and the crop's side over the focal length, at
    `distance_m`; see `root_in_view`.
    """

    local_xyzw: Singles
    camera_from_root_xyzw: Singles
    root_m: Singles
    side_rad: Singles
    index: IdMapIndex

    def __len__(self) -> int:
        return len(self.local_xyzw)

    def nearest(
        self, id_map: Bytes, k: int = 10, probes: int = 24, reranked: int = 80
    ) -> tuple[Ints, NDArray[np.float64]]:
        """Indices (k,) and map distances (k,) [px^2] of the poses that look most like a 40x40 id map.

        The map comes from `idmap_crop_kernels.crop_id_map`. A map without any colour has no neighbour.
        """
        if not id_map.any():
            return np.empty(0, np.int64), np.empty(0)
        return self.index.nearest(id_map, k, probes, reranked)

    def blend(self, indices: Ints, distances: NDArray[np.float64]) -> tuple[Floats, Floats]:
        """Local rotations (J,4) and camera_from_root (4,): the weighted blend of some poses.

        Gaussian weights with the mean distance as width, as in [Wang & Popovic 2009, section 4.3];
        quaternions are added in the hemisphere of the nearest one.
        """
        weights = blend_weights(distances)
        local = self.local_xyzw[indices].astype(float)
        root = self.camera_from_root_xyzw[indices].astype(float)
        return _blend_rotations(local, weights), _blend_rotations(root, weights)

    def root_in_view(
        self, indices: Ints, distances: NDArray[np.float64], side_rad: float
    ) -> Floats:
        """The root's position (3,) [m] in the view frame of a crop that spans `side_rad` focal lengths.

        The view frame is the camera's, turned so that its axis goes through the crop's centre; the mean
        body's size is taken for the person's.
        """
        weights = blend_weights(distances)
        root_m = self.root_m[indices].astype(float)
        root_m[:, 2] *= self.side_rad[indices] / side_rad  # twice the size, half as far away
        blended: Floats = weights @ root_m
        return blended


def blend_weights(distances: NDArray[np.float64]) -> NDArray[np.float64]:
    """Weights (k,) that sum to 1."""
    width = max(float(distances.mean()), 1e-9)
    weights = np.exp(-((distances / width) ** 2))
    normalised_weights: NDArray[np.float64] = weights / weights.sum()
    return normalised_weights


def camera_from_view(camera: Camera, centre_px: Floats) -> Floats:
    """Rotation (4,) that takes the camera's optical axis to the ray of a pixel (2,)."""
    ray = np.append(normalised(camera, centre_px), 1.0)
    ray = ray / np.linalg.norm(ray)
    return rotations.canonical(np.array([-ray[1], ray[0], 0.0, 1.0 + ray[2]]))


def _blend_rotations(q_xyzw: Floats, weights: NDArray[np.float64]) -> Floats:
    sign = np.where((q_xyzw * q_xyzw[:1]).sum(axis=-1) < 0.0, -1.0, 1.0)
    return rotations.canonical(np.einsum("k,k...,k...i->...i", weights, sign, q_xyzw))


def content_hash(params: DatabaseParams) -> str:
    """Changes with everything that the database is made of: parameters, poses, body, shirt, crop."""
    digest = hashlib.sha256()
    constants = (
        VERSION, CANVAS, idmap_crop_kernels.SIZE, idmap_crop_kernels.MARGIN, idmap_crop_kernels.TRIM,
        idmap_index_kernels.BLOCK, _POWER, _CHUNK, _FITTED, _LLOYD_ROUNDS,
    )  # fmt: skip
    digest.update(repr((params, constants, ARMS, TORSOS)).encode())
    model = build_model(params.stature_m)
    for array in (model.vertices_m, model.weights, model.rest_m):
        digest.update(array.round(6).tobytes())
    digest.update(model.triangles.tobytes() + shirt_labels(model).label.tobytes())
    return digest.hexdigest()[:32]


def render(
    poses: PoseSet,
    model: BodyModel,
    params: DatabaseParams,
    progress: Progress,
    map_chunks: MapChunks = map,
) -> RenderedPoses:
    """Id maps of poses; `map_chunks` may be the `map` of a thread pool, as the kernel frees the lock."""
    n = len(poses)
    out = RenderedPoses(
        np.zeros((n, PACKED), np.uint8), np.zeros((n, 3), np.float32), np.zeros(n, np.float32)
    )
    is_shirt = np.zeros(len(model.vertices_m), dtype=bool)
    colour = shirt_labels(model).label
    is_shirt[model.triangles[colour > 0]] = True

    body = Shaped(model.vertices_m, model.rest_m, model.centres_m)

    def draw(part: slice) -> None:
        render_poses(
            poses.local_xyzw[part], poses.camera_from_root_xyzw[part], body, plain(model.skin),
            model.triangles, colour, is_shirt, model.parents, params.focal_px, params.distance_m,
            RenderedPoses(out.packed_maps[part], out.root_m[part], out.side_rad[part]),
        )  # fmt: skip

    parts = [slice(a, min(a + _CHUNK, n)) for a in range(0, n, _CHUNK)]
    for done, _ in enumerate(map_chunks(draw, parts), start=1):
        progress(done / len(parts))
    return out


def build_database(
    params: DatabaseParams,
    progress: Progress = lambda _: None,
    map_chunks: MapChunks = map,
) -> PoseDatabase:
    """Draw poses, render them, and index what they look like.

    progress(0..1) is called now and then. Deterministic whatever `map_chunks` does.
    """
    pool = _pool(params, lambda f: progress(0.12 * f))
    model = build_model(params.stature_m)
    drawn = render(pool, model, params, lambda f: progress(0.12 + 0.74 * f), map_chunks)
    stride = max(1, len(pool) // _FITTED)
    projection = fit_projection(drawn.packed_maps[::stride], params.dimensions)
    vectors = np.empty((len(pool), params.dimensions), np.float32)
    for a in range(0, len(pool), _CHUNK):
        vectors[a : a + _CHUNK] = projection.vectors(drawn.packed_maps[a : a + _CHUNK])
    progress(0.94)
    centres = cluster(vectors[::stride], params.cells, _LLOYD_ROUNDS, params.seed)
    owner = nearest_centre(vectors, centres)
    order = np.argsort(owner, kind="stable")
    progress(1.0)
    return PoseDatabase(
        local_xyzw=pool.local_xyzw[order],
        camera_from_root_xyzw=pool.camera_from_root_xyzw[order],
        root_m=drawn.root_m[order],
        side_rad=drawn.side_rad[order],
        index=IdMapIndex(
            projection=projection,
            centres=centres,
            start=np.searchsorted(owner[order], np.arange(params.cells + 1)),
            vectors=vectors[order],
            packed_maps=drawn.packed_maps[order],
        ),
    )


def _pool(params: DatabaseParams, progress: Progress) -> PoseSet:
    """The first `count` poses of the sequence that are possible."""
    wanted = params.count
    local = np.empty((wanted, N_JOINTS, 4), np.float32)
    root = np.empty((wanted, 4), np.float32)
    cube = LowDispersionCube(params.seed)
    have = 0
    while have < wanted:
        part = poses_from_cube(cube.draw(_POWER), params.sampling)
        n = min(len(part), wanted - have)
        local[have : have + n] = part.local_xyzw[:n]
        root[have : have + n] = part.camera_from_root_xyzw[:n]
        have += n
        progress(have / wanted)
    return PoseSet(local, root)
