"""One round of Phong tessellation, which rounds the silhouette of a coarse mesh."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mocapd.body.surface import Surface
from mocapd.sim.person.figure_kernels import vertex_normals
from mocapd.types import Floats

_ROUNDNESS = 0.65  # Boubekeur and Alexa 2008, eq. 5: between flat (0) and fully curved (1)


@dataclass(frozen=True, slots=True, eq=False)
class FineSurface:
    """A `Surface` with a vertex on each edge and the vertices' unit normals (V,3);
    patch (T,): its areas, which a shirt's patches cover."""

    vertices_m: Floats
    normals: Floats
    triangles: NDArray[np.int32]
    patch: NDArray[np.uint8]
    material: NDArray[np.uint8]
    part: NDArray[np.uint8]
    weights: Floats


def subdivide(surface: Surface) -> FineSurface:
    """Each triangle becomes four; the new vertices are lifted towards their ends' tangent planes."""
    vertices, triangles = surface.vertices_m, surface.triangles
    normals = np.empty_like(vertices)
    vertex_normals(vertices, triangles, normals)
    a, b, c = triangles.T
    edges = np.sort(np.concatenate([np.stack(e, -1) for e in ((a, b), (b, c), (c, a))]), axis=1)
    unique, which = np.unique(edges, axis=0, return_inverse=True)
    ab, bc, ca = len(vertices) + which.reshape(3, -1)
    i, j = unique.T
    middle = 0.5 * (vertices[i] + vertices[j])
    lift = np.zeros_like(middle)
    for end in (i, j):
        off = np.einsum("ei,ei->e", vertices[end] - middle, normals[end])
        lift += 0.5 * off[:, None] * normals[end]
    # the rim of a tube's cap is an edge, not a curve
    soft = np.einsum("ei,ei->e", normals[i], normals[j]) > 0.5
    middle += _ROUNDNESS * soft[:, None] * lift
    fine_vertices = np.concatenate([vertices, middle])
    fine_triangles = np.concatenate(
        [np.stack(t, -1) for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    ).astype(np.int32)
    fine_normals = np.empty_like(fine_vertices)
    vertex_normals(fine_vertices, fine_triangles, fine_normals)
    return FineSurface(
        vertices_m=fine_vertices,
        normals=fine_normals,
        triangles=fine_triangles,
        patch=np.tile(surface.area, 4),
        material=np.tile(surface.material, 4),
        part=np.tile(surface.part, 4),
        weights=np.concatenate([surface.weights, 0.5 * (surface.weights[i] + surface.weights[j])]),
    )
