"""What the constraints of the flexible body say, written again with angles and in plain numpy."""

import numpy as np

from mocapd.body.pose_space import full_body
from mocapd.published.hecht2009.mass_spring.body_points import (
    ANKLE,
    ELBOW,
    HEAD,
    HIP,
    KNEE,
    NECK,
    SHOULDER,
    WAIST,
    WRIST,
)
from mocapd.published.hecht2009.mass_spring.mass_spring_body import MassSpringBody
from mocapd.types import Floats

MIRROR = np.array([0, 1, *range(9, 16), *range(2, 9)])  # the points of the other side
OUTWARD = (np.array([1.0, 0.0, 0.0]), np.array([-1.0, 0.0, 0.0]))


def middle(p: Floats, pair: tuple[int, int]) -> Floats:
    out: Floats = 0.5 * (p[pair[0]] + p[pair[1]])
    return out


def trunk_frames(p: Floats) -> tuple[Floats, Floats]:
    """Axes as columns: left, up, forwards; of the upper and of the lower trunk."""
    frames = []
    for line, up in (
        (SHOULDER, middle(p, SHOULDER) - middle(p, WAIST)),
        (HIP, middle(p, WAIST) - middle(p, HIP)),
    ):
        x = unit(p[line[0]] - p[line[1]])
        z = unit(np.cross(x, up))
        frames.append(np.stack([x, np.cross(z, x), z], axis=1))
    return frames[0], frames[1]


def unit(v: Floats) -> Floats:
    out: Floats = v / np.linalg.norm(v)
    return out


def swing_vector(rest: Floats, now: Floats) -> Floats:
    """The rotation vector of the smallest turn from one unit vector to the other, as tan(angle / 2) along its axis."""
    axis = np.cross(rest, now)
    sine = np.linalg.norm(axis)
    if sine < 1e-12:
        return np.zeros(3)
    tangent: Floats = np.tan(0.5 * np.arctan2(sine, rest @ now)) * axis / sine
    return tangent


def turned(rest: Floats, now: Floats, v: Floats) -> Floats:
    """v turned by the smallest turn from `rest` to `now`."""
    axis = np.cross(rest, now)
    sine, cosine = float(np.linalg.norm(axis)), float(rest @ now)
    if sine < 1e-12:
        return v
    k = axis / sine
    out: Floats = v * cosine + np.cross(k, v) * sine + k * (k @ v) * (1 - cosine)
    return out


def worst_angle_rad(body: MassSpringBody, p: Floats) -> float:
    """How far the worst angle of all is beyond its limit."""
    space, upper, lower = full_body(), *trunk_frames(p)
    limits = space.limits
    worst = 0.0

    def box(F: Floats, rest: Floats, way: Floats, low: Floats, high: Floats) -> None:
        nonlocal worst
        s = swing_vector(rest, unit(F.T @ way))
        # back to an angle per axis, which the box is made of
        angle = 2 * np.arctan(s)
        free = np.abs(rest) > 0.5
        excess = np.where(free, 0.0, np.maximum(angle - high, low - angle))
        worst = max(worst, float(excess.max()))

    def bend(
        F: Floats, rest: Floats, to: Floats, a: int, b: int, c: int, low: float, high: float
    ) -> None:
        nonlocal worst
        d, f = F.T @ unit(p[b] - p[a]), F.T @ unit(p[c] - p[b])
        bent = float(np.arccos(np.clip(d @ f, -1, 1)))
        worst = max(worst, bent - np.radians(155))
        r = turned(rest, d, to)
        twist = float(np.arctan2(f @ np.cross(d, r), f @ r))
        # angles about d come round: the excess is the shorter way back
        beyond = max(twist - high, low - twist, 0.0)
        beyond = min(beyond, 2 * np.pi - (high - low) - beyond) if beyond > 0 else 0.0
        worst = max(worst, min(bent - np.radians(10), np.sin(bent) * beyond))

    y = np.array([0.0, 1.0, 0.0])
    girdle = np.radians([35.0, 0.0, 25.0])
    box(upper, y, p[NECK] - middle(p, SHOULDER), -girdle, girdle)
    g = space.group("neck")
    box(upper, y, p[HEAD] - p[NECK], limits.lower_rad[g], limits.upper_rad[g])
    g = space.group("spine")
    box(upper, -y, middle(p, HIP) - middle(p, WAIST), -limits.upper_rad[g], -limits.lower_rad[g])
    for s, side in enumerate(("left", "right")):
        g = space.group(side + "UpperArm")
        low, high = limits.lower_rad[g], limits.upper_rad[g]
        twist = (low[0], high[0]) if s == 0 else (-high[0], -low[0])
        collar_low = np.radians([0.0, 15.0, 22.0 if s == 1 else 0.0])
        collar_high = np.radians([0.0, 15.0, 22.0 if s == 0 else 0.0])
        way = p[ELBOW[s]] - p[SHOULDER[s]]
        box(upper, OUTWARD[s], way, low - collar_low, high + collar_high)
        z = np.array([0.0, 0.0, 1.0])
        bend(upper, OUTWARD[s], z, SHOULDER[s], ELBOW[s], WRIST[s], *twist)
        g = space.group(side + "UpperLeg")
        box(lower, -y, p[KNEE[s]] - p[HIP[s]], limits.lower_rad[g], limits.upper_rad[g])
        knee = np.radians(75.0)
        bend(lower, -y, -z, HIP[s], KNEE[s], ANKLE[s], -knee, knee)
    return worst


def deepest_in_trunk_m(body: MassSpringBody, p: Floats) -> float:
    """How deep elbows, forearms and wrists are in the trunk, in the measure of its smaller half axis."""
    ellipses = body.constraints.trunk
    deepest = 0.0
    upper, lower = trunk_frames(p)
    waist = middle(p, WAIST)
    for s in (0, 1):
        for t in (0.0, 0.5, 1.0):
            at = (1 - t) * p[ELBOW[s]] + t * p[WRIST[s]]
            height = (at - waist) @ upper[:, 1]
            F, end, row, most = upper, middle(p, SHOULDER), 0, 0.85
            if height < 0:
                height = -(at - waist) @ lower[:, 1]
                F, end, row, most = lower, middle(p, HIP), 2, 1.2
                if height < 0:
                    continue
            share = height / abs((end - waist) @ F[:, 1])
            if share > most:
                continue
            share = min(share, 1.0)
            wide, deep, ahead = (1 - share) * ellipses[1] + share * ellipses[row]
            off = at - waist - share * (end - waist)
            rho = np.hypot(off @ F[:, 0] / wide, (off @ F[:, 2] - ahead) / deep)
            deepest = max(deepest, (1.0 - rho) * min(wide, deep))
    return float(deepest)


def legs_too_near_m(body: MassSpringBody, p: Floats) -> float:
    """By how much more the left knee or ankle should be to the left of the right one, along the hip line."""
    across = unit(p[HIP[0]] - p[HIP[1]])
    missing = []
    for pair, (gap, passing_m) in zip((KNEE, ANKLE), body.constraints.gaps, strict=True):
        d = p[pair[0]] - p[pair[1]]
        beside = float(np.linalg.norm(d - (d @ across) * across))
        missing.append(float(gap - max(0.0, beside - passing_m) - d @ across))
    return max(missing)
