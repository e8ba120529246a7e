"""Ray casting of the room: what each pixel sees, and the light each lamp brings there."""

import numpy as np

from mocapd.kernels.decorator import kernel
from mocapd.sim.scenery.furniture import Primitives
from mocapd.sim.scenery.lamps import Lamps
from mocapd.sim.scenery.pattern_kernels import hash01, pattern_albedo
from mocapd.types import Floats, Ints, Singles

_FAR = 1e30


@kernel
def _slab(o: float, d: float) -> tuple[float, float]:
    """Where the ray is between -1 and 1 in one coordinate."""
    if abs(d) < 1e-12:
        return (_FAR, -_FAR) if abs(o) > 1.0 else (-_FAR, _FAR)
    t0, t1 = (-1.0 - o) / d, (1.0 - o) / d
    return (t0, t1) if t0 < t1 else (t1, t0)


@kernel
def _enter(
    shapes: Floats, p: int, x: float, y: float, z: float, u: float, v: float, w: float
) -> float:
    """Distance at which the ray (x, y, z) + s (u, v, w) enters primitive p, or a huge number."""
    x, y, z = x - shapes[p, 0], y - shapes[p, 1], z - shapes[p, 2]
    c, s = shapes[p, 6], shapes[p, 7]
    ox, oy, oz = (c * x - s * z) * shapes[p, 3], y * shapes[p, 4], (s * x + c * z) * shapes[p, 5]
    dx, dy, dz = (c * u - s * w) * shapes[p, 3], v * shapes[p, 4], (s * u + c * w) * shapes[p, 5]
    if shapes[p, 8] > 0.5:
        a = dx * dx + dy * dy + dz * dz
        b = ox * dx + oy * dy + oz * dz
        disc = b * b - a * (ox * ox + oy * oy + oz * oz - 1.0)
        if disc <= 0.0:
            return _FAR
        near = (-b - np.sqrt(disc)) / a
        return near if near > 1e-4 else _FAR
    low, high = _slab(ox, dx)
    t0, t1 = _slab(oy, dy)
    low, high = max(low, t0), min(high, t1)
    if low >= high:
        return _FAR
    t0, t1 = _slab(oz, dz)
    low, high = max(low, t0), min(high, t1)
    return low if low < high and low > 1e-4 else _FAR


@kernel
def _passes(
    ball: Floats, g: int, x: float, y: float, z: float, u: float, v: float, w: float
) -> bool:
    """Whether the unit ray comes near the ball x y z r of thing g."""
    x, y, z = ball[g, 0] - x, ball[g, 1] - y, ball[g, 2] - z
    along = x * u + y * v + z * w
    square = x * x + y * y + z * z
    r2 = ball[g, 3] * ball[g, 3]
    return square < r2 or (along > 0.0 and square - along * along < r2)


@kernel
def _blocked(
    shapes: Floats, first: Ints, ball: Floats, casts: Ints, x: float, y: float, z: float,
    u: float, v: float, w: float, reach: float,
) -> bool:  # fmt: skip
    for g in range(len(casts)):
        if casts[g] and _passes(ball, g, x, y, z, u, v, w):
            for p in range(first[g], first[g + 1]):
                if _enter(shapes, p, x, y, z, u, v, w) < reach:
                    return True
    return False


@kernel
def _face(shapes: Floats, p: int | np.int64, hit: Floats, normal: Floats, uv: Floats) -> None:
    """Normal (3,) in the world and place on the face, uv = u_m, v_m [m], u, v in 0..1."""
    px, py, pz = hit[0] - shapes[p, 0], hit[1] - shapes[p, 1], hit[2] - shapes[p, 2]
    c, s = shapes[p, 6], shapes[p, 7]
    lx, ly, lz = c * px - s * pz, py, s * px + c * pz
    ux, uy, uz = lx * shapes[p, 3], ly * shapes[p, 4], lz * shapes[p, 5]
    if shapes[p, 8] > 0.5:
        nx, ny, nz = ux * shapes[p, 3], uy * shapes[p, 4], uz * shapes[p, 5]
        uv[0], uv[1] = lx + 0.7 * lz, ly + 0.3 * lz
    else:
        nx = ny = nz = 0.0
        if abs(ux) >= abs(uy) and abs(ux) >= abs(uz):
            nx = 1.0 if lx > 0 else -1.0
            uv[0], uv[1], uv[2], uv[3] = lz, ly, 0.5 + 0.5 * uz, 0.5 + 0.5 * uy
        elif abs(uy) >= abs(uz):
            ny = 1.0 if ly > 0 else -1.0
            uv[0], uv[1], uv[2], uv[3] = lx, lz, 0.5 + 0.5 * ux, 0.5 + 0.5 * uz
        else:
            nz = 1.0 if lz > 0 else -1.0
            uv[0], uv[1], uv[2], uv[3] = lx, ly, 0.5 + 0.5 * ux, 0.5 + 0.5 * uy
    size = np.sqrt(nx * nx + ny * ny + nz * nz)
    normal[0], normal[1], normal[2] = (c * nx + s * nz) / size, ny / size, (-s * nx + c * nz) / size


@kernel
def cast_room(
    origin: Floats, directions: Singles, room: Primitives, lamps: Lamps, sky: Floats, sample: int,
    layers: Singles, points: Singles,
) -> None:  # fmt: skip
    """Add one sample per pixel to layers (L+1,H,W,3): layer 0 ambient light and sky, layer 1+l lamp l.

    directions (H,W,3) unit rays of this sample; points (H,W,3) receives where they end [m, world]
    (NaN: sky). A pixel's random offset on the lamp's disc makes shadows soft over the samples.
    """
    shapes, albedo, pattern, glow, lamp, seed, first, ball, casts = room
    light_at, light_rgb, _, _, ambient_up, ambient_down = lamps
    height, width = directions.shape[:2]
    hit, normal, uv, rgb = np.empty(3), np.empty(3), np.zeros(4), np.empty(3)
    for y in range(height):
        for x in range(width):
            u = np.float64(directions[y, x, 0])
            v = np.float64(directions[y, x, 1])
            w = np.float64(directions[y, x, 2])
            best: int | np.int64 = np.int64(-1)
            near = _FAR
            for g in range(len(casts)):
                if _passes(ball, g, origin[0], origin[1], origin[2], u, v, w):
                    for p in range(first[g], first[g + 1]):
                        s = _enter(shapes, p, origin[0], origin[1], origin[2], u, v, w)
                        if s < near:
                            best, near = p, s
            if best < 0:
                points[y, x, :] = np.nan
                for c in range(3):
                    layers[0, y, x, c] += sky[c] * (1.15 - 0.75 * max(v, 0.0) ** 0.7)
                continue
            hit[0], hit[1], hit[2] = (
                origin[0] + near * u,
                origin[1] + near * v,
                origin[2] + near * w,
            )
            for c in range(3):
                points[y, x, c] = hit[c]
                rgb[c] = albedo[best, c]
            _face(shapes, best, hit, normal, uv)
            # compiled into this kernel: the cache of compiled code knows of a change there by this file alone
            pattern_albedo(pattern[best], uv[0], uv[1], uv[2], uv[3], seed[best], rgb)
            up = 0.5 + 0.5 * normal[1]
            # corners and the space under furniture get less of the light from everywhere
            corner = 0.72 + 0.28 * min(max(hit[1], 0.0) / 0.5, 1.0)
            for c in range(3):
                light = up * ambient_up[c] + (1 - up) * ambient_down[c]
                layers[0, y, x, c] += rgb[c] * corner * light
                hit[c] += 1e-3 * normal[c]
            if glow[best] > 0.0 and lamp[best] >= 0:
                for c in range(3):
                    layers[1 + lamp[best], y, x, c] += glow[best] * light_rgb[lamp[best], c]
            for k in range(len(light_at)):
                strength = _facing(k, x, y, sample, hit, normal, room, lamps)
                for c in range(3):
                    layers[1 + k, y, x, c] += rgb[c] * light_rgb[k, c] * strength


@kernel
def _facing(
    k: int, x: int, y: int, sample: int, hit: Floats, normal: Floats, room: Primitives, lamps: Lamps,
) -> float:  # fmt: skip
    """Lambert's cosine over the squared distance to lamp k, 0 in its shadow."""
    light_at, _, light_radius, light_sun, _, _ = lamps
    near = 0.0 if light_sun[k] else 1.0
    r = light_radius[k]
    u = light_at[k, 0] - near * hit[0] + r * (2 * hash01(x, y, 31 * sample + k) - 1)
    v = light_at[k, 1] - near * hit[1] + r * (2 * hash01(x, y, 31 * sample + k + 977) - 1)
    w = light_at[k, 2] - near * hit[2] + r * (2 * hash01(x, y, 31 * sample + k + 1987) - 1)
    square = u * u + v * v + w * w
    distance = np.sqrt(square)
    u, v, w = u / distance, v / distance, w / distance
    cosine = u * normal[0] + v * normal[1] + w * normal[2]
    reach = 50.0 if light_sun[k] else distance - 0.02
    if cosine <= 0.0 or _blocked(
        room.shapes, room.first, room.ball, room.casts, hit[0], hit[1], hit[2], u, v, w, reach
    ):
        return 0.0
    return float(cosine if light_sun[k] else cosine / max(square, 0.04))
