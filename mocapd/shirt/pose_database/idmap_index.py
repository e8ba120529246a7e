"""Nearest id maps quickly: a short vector per map, cells of similar ones, the exact distance last.

Recall against the exact distance over all maps is measured by
`python -m lab.measure_database`; see docs/decisions/pose-database.md.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.shirt.pose_database.idmap_crop_kernels import N_IDS, SIZE, pack
from mocapd.shirt.pose_database.idmap_distance_kernels import nearest_in_order, one_way_distances
from mocapd.shirt.pose_database.idmap_index_kernels import LENGTH, describe_packed, scan_cells
from mocapd.types import Bytes, Ints, Singles

PACKED = SIZE * SIZE // 2


def nearest_exact(
    query: Bytes, maps: Bytes, candidates: Ints, best: Ints, distance: NDArray[np.float64]
) -> None:
    """The k = len(best) nearest of maps[candidates] to `query` (SIZE,SIZE), nearest first.

    maps (N, SIZE*SIZE/2) packed. The direction that is one table look-up a pixel comes first, and the
    other only where the first alone does not exceed the k-th best. best holds indices into `maps`, -1
    where there are fewer than k candidates.
    """
    one_way = np.empty(len(candidates))
    one_way_distances(query, maps, candidates, np.empty((N_IDS, SIZE, SIZE), np.float32), one_way)
    order = np.argsort(one_way, kind="stable")  # numpy's: numba takes two seconds to compile a sort
    nearest_in_order(query, maps, candidates[order], one_way[order], best, distance)


@dataclass(frozen=True, slots=True, eq=False)
class Projection:
    """Principal axes of the raw descriptors: mean (LENGTH,), basis (LENGTH,D)."""

    mean: Singles
    basis: Singles

    def vectors(self, packed_maps: Bytes) -> Singles:
        """Vectors (N,D) of packed maps (N, PACKED)."""
        raw = np.empty((len(packed_maps), LENGTH), np.float32)
        describe_packed(packed_maps, raw)
        vectors: Singles = np.matmul(raw - self.mean, self.basis, dtype=np.float32)
        return vectors


def fit_projection(packed_maps: Bytes, dimensions: int) -> Projection:
    """The axes along which the descriptors of these maps vary most."""
    raw = np.empty((len(packed_maps), LENGTH), np.float32)
    describe_packed(packed_maps, raw)
    mean = raw.mean(axis=0)
    raw -= mean
    _, axes = np.linalg.eigh((raw.T @ raw).astype(np.float64))
    # eigh sorts upwards; an axis' sign is arbitrary, so fix it
    basis = axes[:, ::-1][:, :dimensions]
    basis = basis * np.sign(basis[np.abs(basis).argmax(axis=0), np.arange(basis.shape[1])])
    return Projection(mean, np.ascontiguousarray(basis, dtype=np.float32))


def cluster(vectors: Singles, cells: int, rounds: int, seed: int) -> Singles:
    """Centres (cells,D) of the vectors by Lloyd's algorithm from a random start; empty cells stay."""
    centres = vectors[np.random.default_rng(seed).choice(len(vectors), cells, replace=False)]
    for _ in range(rounds):
        owner = nearest_centre(vectors, centres)
        order = np.argsort(owner, kind="stable")
        present, start = np.unique(owner[order], return_index=True)
        sums = np.add.reduceat(vectors[order], start, axis=0)
        centres = centres.copy()
        centres[present] = sums / np.diff(np.append(start, len(order)))[:, None]
    return centres


def nearest_centre(vectors: Singles, centres: Singles) -> Ints:
    """The cell (N,) of each vector."""
    norm = (centres**2).sum(axis=1)
    return np.concatenate(
        [
            np.argmin(norm - 2.0 * (block @ centres.T), axis=1)
            for block in np.array_split(vectors, max(1, len(vectors) // 8192))
        ]
    )


@dataclass(frozen=True, slots=True, eq=False)
class IdMapIndex:
    """packed_maps (N, PACKED) and vectors (N,D) sorted by cell: cell c is start[c] : start[c + 1]."""

    projection: Projection
    centres: Singles  # (C, D)
    start: Ints  # (C+1,)
    vectors: Singles
    packed_maps: Bytes

    def nearest(
        self, id_map: Bytes, k: int, probes: int, reranked: int
    ) -> tuple[Ints, NDArray[np.float64]]:
        """Indices (k,) and map distances (k,) [px^2] of the nearest maps, nearest first.

        id_map (SIZE,SIZE). The `reranked` nearest vectors of the `probes` nearest cells are compared by
        the exact distance; fewer than k are returned when there are no more.
        """
        packed = np.empty((1, PACKED), np.uint8)
        pack(id_map, packed[0])
        query = self.projection.vectors(packed)[0]
        gaps = ((self.centres - query) ** 2).sum(axis=1)
        probes = min(probes, len(gaps))
        cells = np.argpartition(gaps, probes - 1)[:probes]
        room = int((self.start[cells + 1] - self.start[cells]).sum())
        index, gap = np.empty(room, np.int64), np.empty(room, np.float32)
        scan_cells(query, self.vectors, self.start, cells, index, gap)
        if room > reranked:
            index = index[np.argpartition(gap, reranked - 1)[:reranked]]
        best, distance = np.empty(k, np.int64), np.empty(k)
        nearest_exact(id_map, self.packed_maps, index, best, distance)
        found = best >= 0
        return best[found], distance[found]
