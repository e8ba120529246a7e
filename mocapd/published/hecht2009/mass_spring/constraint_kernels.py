"""Compiled projections of single constraints: each moves its points to the nearest state that satisfies it.

Points share a correction by their inverse masses; a point of infinite mass (inverse 0) stays. The equations are those
of position-based dynamics (Jakobsen 2001; Müller et al. 2007), springs with compliance (Macklin et al. 2016).
"""

import numpy as np
from numpy.typing import NDArray

from mocapd.fit.terms.collision_kernels import ALONG
from mocapd.kernels.decorator import kernel
from mocapd.published.hecht2009.mass_spring.angular_limits import Hinges, Swings

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_TINY = 1e-12
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
        dx = points[b, 0] - points[a, 0]
        dy = points[b, 1] - points[a, 1]
        dz = points[b, 2] - points[a, 2]
        # no way apart is as good as any: downwards
        now = np.sqrt(dx * dx + dy * dy + dz * dz)
        if now < _TINY:
            dy, now = -_TINY, _TINY
        step = (lengths[s] - now - give[s] * multipliers[s]) * shares[s]
        multipliers[s] += step
        f = step / now
        fa, fb = inverse_mass[a] * f, inverse_mass[b] * f
        points[a, 0] -= fa * dx
        points[a, 1] -= fa * dy
        points[a, 2] -= fa * dz
        points[b, 0] += fb * dx
        points[b, 1] += fb * dy
        points[b, 2] += fb * dz


@kernel(error_model="numpy")
def span_frame(points: Array, line: tuple[int, int], base: tuple[int, int], out: Array) -> None:
    """Axes of a part of the trunk, the columns of out (3,3): x along `line` to the left, y up from the middle of `base`
    as far as it is perpendicular to x, z forwards."""
    x0 = points[line[0], 0] - points[line[1], 0]
    x1 = points[line[0], 1] - points[line[1], 1]
    x2 = points[line[0], 2] - points[line[1], 2]
    u0 = points[line[0], 0] + points[line[1], 0] - points[base[0], 0] - points[base[1], 0]
    u1 = points[line[0], 1] + points[line[1], 1] - points[base[0], 1] - points[base[1], 1]
    u2 = points[line[0], 2] + points[line[1], 2] - points[base[0], 2] - points[base[1], 2]
    f = 1.0 / max(np.sqrt(x0 * x0 + x1 * x1 + x2 * x2), _TINY)
    x0, x1, x2 = f * x0, f * x1, f * x2
    z0, z1, z2 = x1 * u2 - x2 * u1, x2 * u0 - x0 * u2, x0 * u1 - x1 * u0
    f = 1.0 / max(np.sqrt(z0 * z0 + z1 * z1 + z2 * z2), _TINY)
    z0, z1, z2 = f * z0, f * z1, f * z2
    out[0, 0], out[1, 0], out[2, 0] = x0, x1, x2
    out[0, 1], out[1, 1], out[2, 1] = z1 * x2 - z2 * x1, z2 * x0 - z0 * x2, z0 * x1 - z1 * x0
    out[0, 2], out[1, 2], out[2, 2] = z0, z1, z2


@kernel
def span_frames(points: Array, out: Array) -> None:
    """Both frames of the trunk, out (2,3,3): UPPER, LOWER."""
    span_frame(points, _SHOULDERS, _WAIST, out[0])
    # up is from the hips to the waist: the frame of the line's reverse has y and z reversed with it
    span_frame(points, _HIPS, _WAIST, out[1])
    for i in range(3):
        out[1, i, 1] = -out[1, i, 1]
        out[1, i, 2] = -out[1, i, 2]


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
        g, i = frame[k], axis[k]
        j, m = _AFTER[i], _AFTER[i + 1]
        w0 = 0.5 * (points[c, 0] + points[c2, 0] - points[a, 0] - points[a2, 0])
        w1 = 0.5 * (points[c, 1] + points[c2, 1] - points[a, 1] - points[a2, 1])
        w2 = 0.5 * (points[c, 2] + points[c2, 2] - points[a, 2] - points[a2, 2])
        long = np.sqrt(w0 * w0 + w1 * w1 + w2 * w2)
        if long < _TINY:
            continue
        di = (frames[g, 0, i] * w0 + frames[g, 1, i] * w1 + frames[g, 2, i] * w2) / long
        dj = (frames[g, 0, j] * w0 + frames[g, 1, j] * w1 + frames[g, 2, j] * w2) / long
        dm = (frames[g, 0, m] * w0 + frames[g, 1, m] * w1 + frames[g, 2, m] * w2) / long
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
            step = (frames[g, r, i] * ei + frames[g, r, j] * ej + frames[g, r, m] * em) / (wa + wc)
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
    for n in range(rows.shape[0]):
        k = rows[n]
        a, b, c = ends[k, 0], ends[k, 1], ends[k, 2]
        wb, wc = inverse_mass[b], inverse_mass[c]
        if wb + wc == 0.0:
            continue
        d0, d1, d2 = (
            points[b, 0] - points[a, 0],
            points[b, 1] - points[a, 1],
            points[b, 2] - points[a, 2],
        )
        f0, f1, f2 = (
            points[c, 0] - points[b, 0],
            points[c, 1] - points[b, 1],
            points[c, 2] - points[b, 2],
        )
        upper = np.sqrt(d0 * d0 + d1 * d1 + d2 * d2)
        lower = np.sqrt(f0 * f0 + f1 * f1 + f2 * f2)
        if upper < _TINY or lower < _TINY:
            continue
        d0, d1, d2 = d0 / upper, d1 / upper, d2 / upper
        f0, f1, f2 = f0 / lower, f1 / lower, f2 / lower
        cos_straight, sin_straight, cos_most = bend[0], bend[1], bend[2]
        along = d0 * f0 + d1 * f1 + d2 * f2
        if along >= cos_straight:
            continue
        # the direction of the T-pose's bend, swung with the upper part: r = t + 2 (s x t + s x (s x t)) / (1 + s.s)
        # with s = (u x d) / (1 + u.d); t is perpendicular to u
        at, i = frame[k], axis[k]
        u0, u1, u2 = (
            sign[k] * frames[at, 0, i],
            sign[k] * frames[at, 1, i],
            sign[k] * frames[at, 2, i],
        )
        t0, t1, t2 = (
            forward[k] * frames[at, 0, 2],
            forward[k] * frames[at, 1, 2],
            forward[k] * frames[at, 2, 2],
        )
        # for t perpendicular to u that is r = t - (d.t) (u + d) / (1 + u.d)
        g = (d0 * t0 + d1 * t1 + d2 * t2) / max(1.0 + u0 * d0 + u1 * d1 + u2 * d2, 1e-6)
        r0, r1, r2 = t0 - g * (u0 + d0), t1 - g * (u1 + d1), t2 - g * (u2 + d2)
        g = 1.0 / max(np.sqrt(r0 * r0 + r1 * r1 + r2 * r2), _TINY)
        r0, r1, r2 = g * r0, g * r1, g * r2
        q0, q1, q2 = d1 * r2 - d2 * r1, d2 * r0 - d0 * r2, d0 * r1 - d1 * r0
        p, q = f0 * r0 + f1 * r1 + f2 * r2, f0 * q0 + f1 * q1 + f2 * q2
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
            f = sin_straight / max(m, _TINY)
            straight = (sin_straight - m) * (sin_straight - m)
            straight += (cos_straight - along) * (cos_straight - along)
            if straight < around:
                new_along, new_p, new_q = cos_straight, f * p, f * q
            else:
                new_p = ep * cos_middle - eq * sin_middle
                new_q = eq * cos_middle + ep * sin_middle
            changed = True
        if new_along < cos_most:
            f = np.sqrt(1.0 - cos_most * cos_most) / max(m, _TINY)
            new_along, new_p, new_q = cos_most, f * new_p, f * new_q
            changed = True
        if not changed:
            continue
        ea, ep, eq = lower * (new_along - along), lower * (new_p - p), lower * (new_q - q)
        ea, ep, eq = ea / (wb + wc), ep / (wb + wc), eq / (wb + wc)
        s0, s1, s2 = (
            ea * d0 + ep * r0 + eq * q0,
            ea * d1 + ep * r1 + eq * q1,
            ea * d2 + ep * r2 + eq * q2,
        )
        points[b, 0] -= wb * s0
        points[b, 1] -= wb * s1
        points[b, 2] -= wb * s2
        points[c, 0] += wc * s0
        points[c, 1] += wc * s1
        points[c, 2] += wc * s2


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
        w0 = 0.5 * (points[_WAIST[0], 0] + points[_WAIST[1], 0])
        w1 = 0.5 * (points[_WAIST[0], 1] + points[_WAIST[1], 1])
        w2 = 0.5 * (points[_WAIST[0], 2] + points[_WAIST[1], 2])
        for n in range(ALONG.shape[0]):
            t = ALONG[n]
            p0 = points[elbow, 0] + t * (points[wrist, 0] - points[elbow, 0]) - w0
            p1 = points[elbow, 1] + t * (points[wrist, 1] - points[elbow, 1]) - w1
            p2 = points[elbow, 2] + t * (points[wrist, 2] - points[elbow, 2]) - w2
            above = frames[0, 0, 1] * p0 + frames[0, 1, 1] * p1 + frames[0, 2, 1] * p2
            below = -(frames[1, 0, 1] * p0 + frames[1, 1, 1] * p1 + frames[1, 2, 1] * p2)
            if above >= 0.0 or below < 0.0:
                part, end, height = 0, 0, max(above, 0.0)
                left, right = _SHOULDERS
            else:
                part, end, height = 1, 2, below
                left, right = _HIPS
            e0 = 0.5 * (points[left, 0] + points[right, 0]) - w0
            e1 = 0.5 * (points[left, 1] + points[right, 1]) - w1
            e2 = 0.5 * (points[left, 2] + points[right, 2]) - w2
            whole = abs(frames[part, 0, 1] * e0 + frames[part, 1, 1] * e1 + frames[part, 2, 1] * e2)
            if part == 0 and height > (1.0 - _BELOW_SHOULDERS) * whole:
                continue
            if part == 1 and height > whole + _BELOW_HIPS_M:
                continue
            share = min(height / max(whole, _TINY), 1.0)
            wide = trunk[1, 0] + share * (trunk[end, 0] - trunk[1, 0])
            deep = trunk[1, 1] + share * (trunk[end, 1] - trunk[1, 1])
            ahead = trunk[1, 2] + share * (trunk[end, 2] - trunk[1, 2])
            # the axis leads from waist to the end's middle, which is beside the frame's y where the trunk is bent
            x = (
                frames[part, 0, 0] * (p0 - share * e0)
                + frames[part, 1, 0] * (p1 - share * e1)
                + frames[part, 2, 0] * (p2 - share * e2)
            )
            z = (
                frames[part, 0, 2] * (p0 - share * e0)
                + frames[part, 1, 2] * (p1 - share * e1)
                + frames[part, 2, 2] * (p2 - share * e2)
            )
            z -= ahead
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
                step = (ex * frames[part, r, 0] + ez * frames[part, r, 2]) / norm
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
    for row in range(rows.shape[0]):
        k = rows[row]
        left, right = pairs[k, 0], pairs[k, 1]
        w = inverse_mass[left] + inverse_mass[right]
        if w == 0.0:
            continue
        apart, square = 0.0, 0.0
        for r in range(3):
            d = points[left, r] - points[right, r]
            apart += frames[1, r, 0] * d
            square += d * d
        if apart >= gaps[k, 0]:
            continue
        beside = np.sqrt(max(square - apart * apart, 0.0))
        gap = gaps[k, 0] - max(beside - gaps[k, 1], 0.0)
        if apart >= gap:
            continue
        step = (gap - apart) / w
        for r in range(3):
            points[left, r] += inverse_mass[left] * step * frames[1, r, 0]
            points[right, r] -= inverse_mass[right] * step * frames[1, r, 0]
