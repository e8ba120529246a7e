"""Meshes as Panda3D nodes, from arrays: vertices, normals, colours, texture coordinates, triangles."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from panda3d.core import (
    Geom,
    GeomEnums,
    GeomLines,
    GeomNode,
    GeomTriangles,
    GeomVertexArrayFormat,
    GeomVertexData,
    GeomVertexFormat,
    InternalName,
    NodePath,
)

from mocapd.types import Floats, Ints

_USUAL_LENGTH_M = 0.3  # of a limb


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """vertices (V,3) in Panda3D's axes; normals (V,3) of length 1; colours (V,4) 0..1; uv (V,2); triangles (T,3)
    counter-clockwise from outside."""

    vertices: Floats
    normals: Floats
    colours: Floats
    uv: Floats
    triangles: Ints


@dataclass(frozen=True, slots=True)
class Ring:
    """A cross-section of a lofted limb: at `along` of its length, half-axes across and in depth [m], colour."""

    along: float
    across_m: float
    depth_m: float
    colour: tuple[float, float, float]


def loft(rings: list[Ring], sides: int = 12) -> Mesh:
    """Ellipses in a row along +Z, of length 1, closed at both ends; +X is across and +Y depth."""
    angle = 2 * np.pi * np.arange(sides + 1) / sides
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    n = sides + 1
    half = np.array([[ring.across_m, ring.depth_m] for ring in rings])
    along = np.array([ring.along for ring in rings])
    vertices = np.concatenate(
        [circle * half[:, None], np.broadcast_to(along[:, None, None], (len(rings), n, 1))], axis=2
    )
    slope = _slopes(half.mean(axis=1), _USUAL_LENGTH_M * along)
    normals = np.concatenate(
        [
            circle / np.maximum(half[:, None], 1e-4) * half.mean(axis=1)[:, None, None],
            np.broadcast_to(-slope[:, None, None], (len(rings), n, 1)),
        ],
        axis=2,
    )
    normals /= np.linalg.norm(normals, axis=2, keepdims=True)
    colours = np.array([[*ring.colour, 1.0] for ring in rings]).repeat(n, axis=0)
    uv = np.stack(np.broadcast_arrays(angle[None] / (2 * np.pi), along[:, None]), axis=-1)
    return Mesh(
        vertices.reshape(-1, 3), normals.reshape(-1, 3), colours, uv.reshape(-1, 2),
        _grid_triangles(len(rings), n),
    )  # fmt: skip


def _slopes(radius_m: Floats, at_m: Floats) -> Floats:
    """How steeply a profile widens at each ring, from its neighbours; two rings at one place are a seam of colours."""
    last, following = np.arange(len(at_m)) - 1, np.arange(len(at_m)) + 1
    last, following = np.maximum(last, 0), np.minimum(following, len(at_m) - 1)
    apart_m = np.maximum(at_m[following] - at_m[last], 0.01)
    out: Floats = np.clip((radius_m[following] - radius_m[last]) / apart_m, -5.0, 5.0)
    return out


def ball_mesh(radius_m: float, rows: int = 12, columns: int = 18) -> Mesh:
    """A sphere whose texture is unrolled from pole to pole."""
    down = np.pi * np.arange(rows + 1)[:, None] / rows
    around = 2 * np.pi * np.arange(columns + 1)[None] / columns
    normals = np.stack(
        np.broadcast_arrays(
            np.sin(down) * np.cos(around), np.sin(down) * np.sin(around), np.cos(down)
        ),
        axis=-1,
    ).reshape(-1, 3)
    uv = np.stack(np.broadcast_arrays(around / (2 * np.pi), 1.0 - down / np.pi), axis=-1)
    triangles = _grid_triangles(rows + 1, columns + 1)[:, ::-1]
    return Mesh(
        radius_m * normals, normals, np.ones((len(normals), 4)), uv.reshape(-1, 2), triangles
    )


def quad(corners: Floats, uv_size: tuple[float, float], colour: tuple[float, ...]) -> Mesh:
    """A rectangle of four corners (4,3), counter-clockwise from the lower left as its front is seen; the texture is
    repeated so often."""
    corners = np.asarray(corners, dtype=float)
    normal = np.cross(corners[1] - corners[0], corners[3] - corners[0])
    normal /= np.linalg.norm(normal)
    u, v = uv_size
    return Mesh(
        corners,
        np.tile(normal, (4, 1)),
        np.tile((*colour, 1.0) if len(colour) == 3 else colour, (4, 1)),
        np.array([[0, 0], [u, 0], [u, v], [0, v]], dtype=float),
        np.array([[0, 1, 2], [0, 2, 3]]),
    )


def box(middle_m: Floats, size_m: Floats, colour: tuple[float, float, float]) -> Mesh:
    """An upright box, its faces shaded by where they look: light comes from above and from the front."""
    faces = []
    for axis in range(3):
        for side in (-1.0, 1.0):
            normal = np.zeros(3)
            normal[axis] = side
            a, b = np.roll(np.eye(3), -axis - 1, axis=0)[:2] * side
            if side < 0:
                a, b = np.abs(a), -np.abs(b)
            corners = np.array(
                [normal + s * a + t * b for s, t in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
            )
            light = 0.62 + 0.38 * normal[2] - 0.12 * normal[1]
            shaded = tuple(min(light * c, 1.0) for c in colour)
            faces.append(
                quad(np.asarray(middle_m) + 0.5 * corners * np.asarray(size_m), (1, 1), shaded)
            )
    return joined(faces)


def joined(meshes: list[Mesh]) -> Mesh:
    """Several as one: one call to draw."""
    starts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return Mesh(
        np.concatenate([mesh.vertices for mesh in meshes]),
        np.concatenate([mesh.normals for mesh in meshes]),
        np.concatenate([mesh.colours for mesh in meshes]),
        np.concatenate([mesh.uv for mesh in meshes]),
        np.concatenate([mesh.triangles + k for mesh, k in zip(meshes, starts, strict=True)]),
    )


def node_of(name: str, mesh: Mesh) -> NodePath:
    """A node, not yet in any scene."""
    rows = np.concatenate([mesh.vertices, mesh.normals, mesh.colours, mesh.uv], axis=1)
    columns = (("vertex", 3), ("normal", 3), ("color", 4), ("texcoord", 2))
    return _node(name, rows, columns, GeomTriangles(Geom.UHStatic), mesh.triangles)


def node_of_lines(name: str, ends: Floats, colour: tuple[float, float, float]) -> NodePath:
    """Straight lines one pixel wide, from ends[:,0] to ends[:,1] (N,2,3)."""
    points = ends.reshape(-1, 3)
    rows = np.concatenate([points, np.tile((*colour, 1.0), (len(points), 1))], axis=1)
    pairs: Ints = np.arange(len(points)).reshape(-1, 2)
    return _node(name, rows, (("vertex", 3), ("color", 4)), GeomLines(Geom.UHStatic), pairs)


_CONTENTS = {
    "vertex": GeomEnums.C_point,
    "normal": GeomEnums.C_normal,
    "color": GeomEnums.C_color,
    "texcoord": GeomEnums.C_texcoord,
}


def _node(
    name: str, rows: Floats, columns: tuple[tuple[str, int], ...], primitive: Any, indices: Ints
) -> NodePath:
    """rows (V,C): the columns side by side; indices (N,2) or (N,3): the vertices of each line or triangle."""
    array = GeomVertexArrayFormat()
    for column, size in columns:
        array.addColumn(InternalName.make(column), size, GeomEnums.NT_float32, _CONTENTS[column])
    vertex_format = GeomVertexFormat.registerFormat(GeomVertexFormat(array))
    data = GeomVertexData(name, vertex_format, Geom.UHStatic)
    data.uncleanSetNumRows(len(rows))
    _fill(data.modifyArray(0), np.ascontiguousarray(rows, dtype=np.float32), "f")
    primitive.setIndexType(GeomEnums.NT_uint32)
    table = primitive.modifyVertices()
    table.uncleanSetNumRows(indices.size)
    _fill(table, np.ascontiguousarray(indices, dtype=np.uint32), "I")
    geom = Geom(data)
    geom.addPrimitive(primitive)
    node = GeomNode(name)
    node.addGeom(geom)
    return NodePath(node)


def _fill(array: Any, values: Any, kind: Literal["f", "I"]) -> None:
    view: Any = memoryview(array).cast("B")
    view.cast(kind)[:] = memoryview(values.ravel())


def _grid_triangles(rows: int, columns: int) -> Ints:
    """Of a grid of vertices, row after row."""
    first = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    right, up = first + 1, first + columns
    return np.concatenate(
        [np.stack([first, right, up + 1], axis=1), np.stack([first, up + 1, up], axis=1)]
    )
