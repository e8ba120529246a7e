"""Compiled projections of single constraints: each moves its points to the nearest state that satisfies it.

Points share a correction by their inverse masses; a point of infinite mass (inverse 0) stays. The equations are those
of position-based dynamics (Jakobsen 2001; Müller et al. 2007), springs with compliance (Macklin et al. 2016).
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.fit.terms.collision_kernels import ALONG
from mocapd.kernels.decorator import kernel
from mocapd.published.hecht2009.mass_spring.angular_limits import Hinges, Swings
from mocapd.published.hecht2009.vector_kernels import (
    TINY,
    Array,
    Vector,
    cross,
    dot,
    minus,
    move,
    over,
    times,
    unit,
)

Ints = NDArray[np.int64]

_AFTER = (1, 2, 0, 1)  # the axis after each, and the one after that
# the left, the right, as in `body_points`; numba takes tuples as constants
_SHOULDERS, _WAIST, _HIPS = (2, 9), (5, 12), (6, 13)
_BELOW_HIPS_M = 0.06  # the trunk's cylinder ends there
_LEAST_LEVER = 0.2
# and by that share of the upper trunk under the shoulders, where the arms begin
_BELOW_SHOULDERS = 0.15


@kernel(error_model="numpy")
def sweep_springs(
    points: Array,
    inverse_mass: Array,
    ends: Ints,
    lengths: Array,
    give: Array,
    shares: Array,
    rows: Ints,
    multipliers: Array,
) -> None:
    """Correct the springs of `rows` one after the other.

    give (S,): compliance / dt^2 [1/kg]; shares (S,): 1 / (inverse masses of both ends + give), 0 where both ends stay;
    multipliers (S,): what its sweeps have added up to.
    """
    for k in range(rows.shape[0]):
        s = rows[k]
        a, b = ends[s, 0], ends[s, 1]
        way = minus(points[b], points[a])
        now = np.sqrt(dot(way, way))
        if now < TINY:
            # no way apart is as good as any: downwards
            way, now = (way[0], -TINY, way[2]), TINY
        step = (lengths[s] - now - give[s] * multipliers[s]) * shares[s]
        multipliers[s] += step
        f = step / now
        move(points[a], -inverse_mass[a] * f, way)
        move(points[b], inverse_mass[b] * f, way)


@kernel
def _twice_way(points: Array, start: tuple[int, int], end: tuple[int, int]) -> Vector:
    """From the middle of two points to that of two others, twice."""
    a, b, c, d = points[end[0]], points[end[1]], points[start[0]], points[start[1]]
    return a[0] + b[0] - c[0] - d[0], a[1] + b[1] - c[1] - d[1], a[2] + b[2] - c[2] - d[2]


@kernel
def _middle(points: Array, ends: tuple[int, int]) -> Vector:
    a, b = points[ends[0]], points[ends[1]]
    return 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])


@kernel
def span_frame(points: Array, line: tuple[int, int], base: tuple[int, int], out: Array) -> None:
    """Axes of a part of the trunk, the rows of out (3,3): x along `line` to the left, y up from the middle of `base` as far
    as it is perpendicular to x, z forwards."""
    x = unit(minus(points[line[0]], points[line[1]]))
    z = unit(cross(x, _twice_way(points, base, line)))
    y = cross(z, x)
    for r in range(3):
        out[0, r], out[1, r], out[2, r] = x[r], y[r], z[r]


@kernel
def span_frames(points: Array, out: Array) -> None:
    """Both frames of the trunk, out (2,3,3): UPPER, LOWER; their axes are the rows."""
    span_frame(points, _SHOULDERS, _WAIST, out[0])
    # up is from the hips to the waist: the frame of the line's reverse has y and z reversed with it
    span_frame(points, _HIPS, _WAIST, out[1])
    for r in range(3):
        out[1, 1, r] = -out[1, 1, r]
        out[1, 2, r] = -out[1, 2, r]


@kernel(error_model="numpy")
def sweep_swings(
    points: Array, inverse_mass: Array, swings: Swings, rows: Ints, frames: Array
) -> None:
    """Turn the parts of `rows` that left their box back into it."""
    ends, frame, axis, sign, lower, upper = swings
    for n in range(rows.shape[0]):
        k = rows[n]
        a, a2, c, c2 = ends[k, 0], ends[k, 1], ends[k, 2], ends[k, 3]
        wa, wc = (
            0.5 * (inverse_mass[a] + inverse_mass[a2]),
            0.5 * (inverse_mass[c] + inverse_mass[c2]),
        )
        if wa + wc == 0.0:
            continue
        i = axis[k]
        j, m = _AFTER[i], _AFTER[i + 1]
        along, beside, above = frames[frame[k], i], frames[frame[k], j], frames[frame[k], m]
        way = times(0.5, _twice_way(points, (a, a2), (c, c2)))
        long = np.sqrt(dot(way, way))
        if long < TINY:
            continue
        di, dj, dm = dot(along, way) / long, dot(beside, way) / long, dot(above, way) / long
        f = sign[k] / max(1.0 + sign[k] * di, 1e-6)
        sj, sm = -f * dm, f * dj
        lj, uj, lm, um = lower[k, 0], upper[k, 0], lower[k, 1], upper[k, 1]
        if lj <= sj <= uj and lm <= sm <= um:
            continue
        sj, sm = min(max(sj, lj), uj), min(max(sm, lm), um)
        f = sign[k] / (1.0 + sj * sj + sm * sm)
        ei = long * (f * (1.0 - sj * sj - sm * sm) - di)
        ej = long * (2.0 * f * sm - dj)
        em = long * (-2.0 * f * sj - dm)
        for r in range(3):
            step = (along[r] * ei + beside[r] * ej + above[r] * em) / (wa + wc)
            points[a, r] -= inverse_mass[a] * step
            if a != a2:
                points[a2, r] -= inverse_mass[a2] * step
            points[c, r] += inverse_mass[c] * step
            if c != c2:
                points[c2, r] += inverse_mass[c2] * step


@kernel(error_model="numpy")
def sweep_hinges(
    points: Array, inverse_mass: Array, hinges: Hinges, rows: Ints, frames: Array
) -> None:
    """Turn the lower parts of `rows` back to where their joints bend."""
    ends, frame, axis, sign, forward, side, bend = hinges
    cos_straight, sin_straight, cos_most = bend[0], bend[1], bend[2]
    for n in range(rows.shape[0]):
        k = rows[n]
        a, b, c = ends[k, 0], ends[k, 1], ends[k, 2]
        wb, wc = inverse_mass[b], inverse_mass[c]
        if wb + wc == 0.0:
            continue
        d, e = minus(points[b], points[a]), minus(points[c], points[b])
        upper, lower = np.sqrt(dot(d, d)), np.sqrt(dot(e, e))
        if upper < TINY or lower < TINY:
            continue
        d, e = over(d, upper), over(e, lower)
        along = dot(d, e)
        if along >= cos_straight:
            continue
        # the direction of the T-pose's bend, swung with the upper part: r = t + 2 (s x t + s x (s x t)) / (1 + s.s)
        # with s = (u x d) / (1 + u.d); t is perpendicular to u
        u = times(sign[k], frames[frame[k], axis[k]])
        t = times(forward[k], frames[frame[k], 2])
        # for t perpendicular to u that is r = t - (d.t) (u + d) / (1 + u.d)
        g = dot(d, t) / max(1.0 + u[0] * d[0] + u[1] * d[1] + u[2] * d[2], 1e-6)
        r = unit((t[0] - g * (u[0] + d[0]), t[1] - g * (u[1] + d[1]), t[2] - g * (u[2] + d[2])))
        s = cross(d, r)
        p, q = dot(e, r), dot(e, s)
        m = np.sqrt(p * p + q * q)
        new_along, new_p, new_q = along, p, q
        changed = False
        # in the frame of the middle of the allowed sides
        cos_middle, sin_middle, cos_half, sin_half = side[k, 0], side[k, 1], side[k, 2], side[k, 3]
        pm, qm = p * cos_middle + q * sin_middle, q * cos_middle - p * sin_middle
        if pm < cos_half * m:
            edge = sin_half if qm >= 0.0 else -sin_half
            ep, eq = m * cos_half, m * edge
            around = (ep - pm) * (ep - pm) + (eq - qm) * (eq - qm)
            # or straighter: whichever is nearer
            f = sin_straight / max(m, TINY)
            straight = (sin_straight - m) * (sin_straight - m)
            straight += (cos_straight - along) * (cos_straight - along)
            if straight < around:
                new_along, new_p, new_q = cos_straight, f * p, f * q
            else:
                new_p = ep * cos_middle - eq * sin_middle
                new_q = eq * cos_middle + ep * sin_middle
            changed = True
        if new_along < cos_most:
            f = np.sqrt(1.0 - cos_most * cos_most) / max(m, TINY)
            new_along, new_p, new_q = cos_most, f * new_p, f * new_q
            changed = True
        if not changed:
            continue
        off = lower * (new_along - along), lower * (new_p - p), lower * (new_q - q)
        ed, er, es = over(off, wb + wc)
        for i in range(3):
            step = ed * d[i] + er * r[i] + es * s[i]
            points[b, i] -= wb * step
            points[c, i] += wc * step


@kernel(error_model="numpy")
def push_arms_out(
    points: Array, inverse_mass: Array, arms: Ints, rows: Ints, trunk: Array, frames: Array
) -> None:
    """Push elbow, forearm, wrist and hand of arms[rows] out of the trunk, which does not give way.

    trunk (3,3): half breadth, half depth, middle in front of the points at shoulders, waist and hips [m], the cross-sections
    of two elliptic cylinders, between which they change evenly. The way out is from the axis, in the ellipse's measure.
    """
    for row in range(rows.shape[0]):
        elbow, wrist = arms[rows[row], 0], arms[rows[row], 1]
        if inverse_mass[elbow] + inverse_mass[wrist] == 0.0:
            continue
        waist = _middle(points, _WAIST)
        for n in range(ALONG.shape[0]):
            t = ALONG[n]
            a, b = points[elbow], minus(points[wrist], points[elbow])
            p = minus((a[0] + t * b[0], a[1] + t * b[1], a[2] + t * b[2]), waist)
            above, below = dot(frames[0, 1], p), -dot(frames[1, 1], p)
            if above >= 0.0 or below < 0.0:
                part, end, height, line = 0, 0, max(above, 0.0), _SHOULDERS
            else:
                part, end, height, line = 1, 2, below, _HIPS
            e = minus(_middle(points, line), waist)
            whole = abs(dot(frames[part, 1], e))
            if part == 0 and height > (1.0 - _BELOW_SHOULDERS) * whole:
                continue
            if part == 1 and height > whole + _BELOW_HIPS_M:
                continue
            share = min(height / max(whole, TINY), 1.0)
            wide = trunk[1, 0] + share * (trunk[end, 0] - trunk[1, 0])
            deep = trunk[1, 1] + share * (trunk[end, 1] - trunk[1, 1])
            ahead = trunk[1, 2] + share * (trunk[end, 2] - trunk[1, 2])
            # the axis leads from waist to the end's middle, which is beside the frame's y where the trunk is bent
            from_axis = minus(p, times(share, e))
            x, z = dot(frames[part, 0], from_axis), dot(frames[part, 2], from_axis) - ahead
            u, v = x / wide, z / deep
            rho2 = u * u + v * v
            if rho2 >= 1.0:
                continue
            rho = np.sqrt(rho2)
            if rho < 1e-3:  # from the axis itself: forwards
                ex, ez = 0.0, deep
            else:
                ex, ez = x * (1.0 / rho - 1.0), z * (1.0 / rho - 1.0)
            se, sw = (1.0 - t) * inverse_mass[elbow], t * inverse_mass[wrist]
            norm = (1.0 - t) * se + t * sw
            # a hand beyond a fixed wrist has a short lever: it would throw the elbow far
            if norm < _LEAST_LEVER * max(inverse_mass[elbow], inverse_mass[wrist]):
                continue
            for r in range(3):
                step = (ex * frames[part, 0, r] + ez * frames[part, 2, r]) / norm
                points[elbow, r] += se * step
                points[wrist, r] += sw * step


@kernel
def part_pairs(
    points: Array, inverse_mass: Array, pairs: Ints, gaps: Array, rows: Ints, frames: Array
) -> None:
    """Keep a plane, perpendicular to the hip line, between left and right points pairs[rows].

    gaps (P,2) [m]: how wide, and how far apart along the plane legs begin to pass: beyond that the gap narrows by as much as
    they are farther apart, and they may cross.
    """
    across = frames[1, 0]
    for row in range(rows.shape[0]):
        k = rows[row]
        left, right = pairs[k, 0], pairs[k, 1]
        w = inverse_mass[left] + inverse_mass[right]
        if w == 0.0:
            continue
        way = minus(points[left], points[right])
        apart = dot(across, way)
        if apart >= gaps[k, 0]:
            continue
        beside = np.sqrt(max(dot(way, way) - apart * apart, 0.0))
        gap = gaps[k, 0] - max(beside - gaps[k, 1], 0.0)
        if apart >= gap:
            continue
        step = (gap - apart) / w
        move(points[left], inverse_mass[left] * step, across)
        move(points[right], -inverse_mass[right] * step, across)
