"""When an arm does not agree with the pictures: other poses of it are tried, the best is kept.

A tracked arm can slip into a pose that looks right to one camera. Candidates are its mirror images
in depth along each camera's view (the two poses of a segment that project alike, Sminchisescu and
Triggs 2003), and a low-discrepancy cloud about the present pose and about rest.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mocapd.body.joint_limits import from_swing_twist
from mocapd.body.pose_space import SIDES, PoseSpace
from mocapd.body.skeleton import PARENTS
from mocapd.fit.arm_samples import SKIN_ID, Arm, arm_of, placed
from mocapd.fit.body_drawing import PartialRender
from mocapd.fit.fit_params import LimbSearchParams
from mocapd.fit.limb_search_kernels import ArmSamples, crowd_arms, score_arms
from mocapd.fit.motion_state import MotionState
from mocapd.fit.pose_prior import arm_motions, unusualness
from mocapd.fit.reaching import reaching_poses
from mocapd.fit.solver import Fit, Fitter, View
from mocapd.fit.terms.pose_term import PoseTerm
from mocapd.geometry import rotations
from mocapd.types import Camera, Floats

_LIBRARY = 2048
_NO_DEPTHS = np.empty((0, 0), np.float32)
_ALIKE = 0.985  # cosine of half the angle between two poses of a bone, 20 degrees
PX_OF_M2 = 3.7e4  # work pixels that a square metre takes, by its distance [px m]; of usual lenses at some 2.7 m


def candidates(
    fitter: Fitter,
    state: MotionState,
    limb: Arm,
    views: Sequence[View],
    cloud: Floats,
    library: Floats,
    first: int = 1,
) -> Floats:
    """Local rotations (N,3,4) of a limb's first three bones to try; the first is the present pose.

    cloud (C,6): rotation vectors to turn its two long bones by; library (L,3,4): poses to try as they are; first: which of
    the three is the first long one, that of an arm after its collar.
    """
    joints, globals_ = fitter.joints(state)
    upper, lower, end = limb.chain[first : first + 3]
    present = state.local_xyzw[limb.chain[:3]]
    out = [present]
    for view in views:
        camera = fitter.drawings[view.index].camera
        for q_upper, q_lower in mirrored_bones(joints, globals_, (upper, lower, end), camera):
            local = present.copy()
            local[first] = rotations.multiply(rotations.inverse(globals_[PARENTS[upper]]), q_upper)
            local[first + 1] = rotations.multiply(rotations.inverse(q_upper), q_lower)
            out.append(local)
    turned = np.repeat(present[None], len(cloud), axis=0)
    turned[:, first : first + 2] = turned_about(present[first : first + 2], cloud)
    return np.concatenate([np.array(out), turned, library])


def mirrored_bones(
    joints: Floats, globals_: Floats, limb: tuple[int, int, int], camera: Camera
) -> list[tuple[Floats, Floats]]:
    """Global rotations (4,) of the two bones between the joints of a limb, either or both mirrored in depth: they project
    alike."""
    upper, lower, end = limb
    a, b = joints[lower] - joints[upper], joints[end] - joints[lower]
    ray = joints[lower] + camera.R.T @ camera.t_m
    ray = ray / np.linalg.norm(ray)
    a_flip, b_flip = a - 2 * (a @ ray) * ray, b - 2 * (b @ ray) * ray
    return [
        (
            rotations.multiply(shortest_turn(a, new_a), globals_[upper]),
            rotations.multiply(shortest_turn(b, new_b), globals_[lower]),
        )
        for new_a, new_b in ((a, b_flip), (a_flip, b), (a_flip, b_flip))
    ]


def shortest_turn(a: Floats, b: Floats) -> Floats:
    """The smallest rotation (4,) that turns direction a into direction b."""
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    w = 1.0 + a @ b
    if w < 1e-6:
        axis = np.cross(a, [1.0, 0.0, 0.0] if abs(a[0]) < 0.9 else [0.0, 1.0, 0.0])
        return np.append(axis / np.linalg.norm(axis), 0.0)
    (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
    q = (
        ay * bz - az * by,
        az * bx - ax * bz,
        ax * by - ay * bx,
        w,
    )  # np.cross takes twenty times as long
    return rotations.canonical(np.array(q))


def score_arm_poses(
    fitter: Fitter,
    state: MotionState,
    arm: Arm,
    views: Sequence[View],
    hypotheses: Floats,
    farther: float,
    empty: float,
) -> Floats:
    """How much of each hypothesis (N,3,4) is seen, less what contradicts it and what is in the trunk (N,) [work px].

    farther: by how much more must be seen of a pose that is a radian away from the first [work px/rad^2]; empty: share of
    what lies where the picture shows none of the shirt's colours that contradicts it.
    """
    model = fitter.model
    body = fitter.shaper(state.factors)
    samples = placed(body, arm, arm.sleeve)
    scores = -farther / PX_OF_M2 * turned_rad2(hypotheses[:, 1:], hypotheses[0, 1:])
    fitter.drawings[views[0].index].pose(state.root_m, state.local_xyzw, body.rest)
    depths_m2 = np.empty(len(hypotheses))
    crowd_arms(
        hypotheses, arm.chain, model.parents, fitter.drawings[views[0].index].posed, fitter.torso(body),
        fitter.arms.hips, fitter.arms.chest, fitter.arms.top, depths_m2,
    )  # fmt: skip
    scores -= fitter.params.collision_information / PX_OF_M2 * depths_m2
    # an arm before a trunk that looks like it is told by depths
    covered = 0.0 if any(view.depth_m is not None for view in views) else 1.0
    scores = added_in_views(fitter, state, arm, views, samples, hypotheses, empty, scores, covered)
    seen_px: Floats = PX_OF_M2 * scores
    return seen_px


def score_hand_places(
    fitter: Fitter,
    state: MotionState,
    arm: Arm,
    views: Sequence[View],
    hypotheses: Floats,
    empty: float,
) -> Floats:
    """How much of the hand of each hypothesis (N,3,4) is seen as bare skin that neither the head nor the other hand is,
    less what contradicts it (N,) [work px]; 0 where nobody looked for skin. empty: as for sleeves."""
    samples = placed(fitter.shaper(state.factors), arm, arm.hand)
    scores = np.zeros(len(hypotheses))
    for view in views:
        if view.bare is None:
            continue
        base = fitter.drawings[view.index].render_parts(state, view.dt_s, view.roi, arm.others)
        drawn = np.where(arm.is_skin[base.triangle_at], np.uint8(SKIN_ID), base.ids)
        seen = np.where(view.bare, np.uint8(SKIN_ID), view.ids)
        score_in_view(fitter, view, base, drawn, seen, samples, hypotheses, empty, scores)
    seen_px: Floats = PX_OF_M2 * scores
    return seen_px


def added_in_views(
    fitter: Fitter,
    state: MotionState,
    limb: Arm,
    views: Sequence[View],
    samples: ArmSamples,
    hypotheses: Floats,
    empty: float,
    scores: Floats,
    covered: float = 1.0,
) -> Floats:
    """scores (N,) and what each camera says of a limb in front of the rest of the body [m^2]; covered: see `score_arms`."""

    def seen_in(view: View) -> Floats:
        base = fitter.drawings[view.index].render_parts(state, view.dt_s, view.roi, limb.others)
        mine = np.zeros(len(hypotheses))
        score_in_view(
            fitter, view, base, base.ids, view.ids, samples, hypotheses, empty, mine, covered
        )
        return mine

    # added up in the order of the views, whichever thread was first
    return sum(fitter.each(seen_in, views), scores)


def score_in_view(
    fitter: Fitter,
    view: View,
    base: PartialRender,
    drawn: NDArray[np.uint8],
    seen: NDArray[np.uint8],
    samples: ArmSamples,
    hypotheses: Floats,
    empty: float,
    scores: Floats,
    covered: float = 1.0,
) -> None:
    """Add what one camera says, of ids (h,w) `drawn` without the arm, and `seen`, to scores (N,) [m^2]; covered: see
    `score_arms`."""
    drawing = fitter.drawings[view.index]
    image_scale = drawing.image_scale
    score_arms(
        hypotheses, samples, fitter.model.parents, base.posed, drawing.projection,
        np.array([float(view.roi[0] * image_scale), float(view.roi[1] * image_scale)]), 1.0 / image_scale,
        base.zbuffer, drawn, seen, view.pixel_weight, empty, covered,
        _NO_DEPTHS if view.depth_m is None else view.depth_m, fitter.params.depth_off_m, scores,
    )  # fmt: skip


def best_poses(bones_xyzw: Floats, scores: Floats, keep: int) -> list[int]:
    """Places of the `keep` best poses of a limb's two long bones (N,2,4), best first, no two alike; none below the first, the
    present pose."""
    out: list[int] = []
    for n in np.argsort(-scores, kind="stable").tolist():
        if n == 0 or len(out) == keep:
            break
        # a hypothesis close to one already kept would end where that one ends
        if not any(_is_alike(bones_xyzw[n], bones_xyzw[kept]) for kept in out):
            out.append(n)
    return out


def _is_alike(a_xyzw: Floats, b_xyzw: Floats) -> bool:
    return bool(np.abs((a_xyzw * b_xyzw).sum(axis=1)).min() > _ALIKE)


def turned_rad2(bones_xyzw: Floats, from_xyzw: Floats) -> Floats:
    """By how much a limb's two long bones differ: squared angles (N,), of poses (N,2,4) from one (2,4) [rad^2]."""
    cosines = np.abs((bones_xyzw * from_xyzw).sum(axis=2))
    turned: Floats = ((2.0 * np.arccos(np.minimum(cosines, 1.0))) ** 2).sum(axis=1)
    return turned


def turned_about(bones_xyzw: Floats, cloud: Floats) -> Floats:
    """Poses (C,2,4) of a limb's two long bones (2,4), turned by the rotation vectors of a cloud (C,6)."""
    turned = np.repeat(bones_xyzw[None], len(cloud), axis=0)
    turned[:, 0] = rotations.multiply(rotations.exp(cloud[:, :3]), turned[:, 0])
    turned[:, 1] = rotations.multiply(rotations.exp(cloud[:, 3:]), turned[:, 1])
    return turned


def arm_library(space: PoseSpace, size: int, side: str) -> Floats:
    """Poses (size,3,4) of one arm spread evenly over its joint limits (Halton), the collar at rest."""
    limits = space.limits
    upper, fore = space.group(side + "UpperArm"), space.group(side + "LowerArm")
    u = spread(size)
    out = np.tile(rotations.IDENTITY_XYZW, (size, 3, 1))
    for place, group, span in ((1, upper, slice(0, 3)), (2, fore, slice(3, 6))):
        low, high = limits.lower_rad[group], limits.upper_rad[group]
        angles = low + (high - low) * u[:, span]
        out[:, place] = from_swing_twist(angles, int(limits.axis[group]))
    return out


class ArmSearch:
    """Tries other poses of arms that the pictures do not confirm"""

    def __init__(self, fitter: Fitter, params: LimbSearchParams) -> None:
        self.fitter, self.params = fitter, params
        self.arms = {side: arm_of(fitter.model, side) for side in SIDES}
        self._library = {side: arm_library(fitter.model.space, _LIBRARY, side) for side in SIDES}
        u = spread(_LIBRARY)
        near = np.where(np.arange(_LIBRARY) % 2, 1.4, 0.6)[:, None]
        self._usual = arm_motions()
        self._cloud = (2.0 * u - 1.0) * near * np.array([1.0, 1.0, 1.0, 0.5, 1.2, 0.5])

    def rehearse(self, state: MotionState, views: Sequence[View]) -> None:
        """Run the search once for nothing: ordinary frames do not reach its kernels, and the first
        uncertain arm must not wait for them to be compiled or loaded."""
        for side, arm in self.arms.items():
            tries = candidates(
                self.fitter, state, arm, views, self._cloud[:1], self._library[side][:1]
            )
            score_arm_poses(self.fitter, state, arm, views, tries, 0.0, 0.0)

    def improve(
        self,
        fit: Fit,
        views: Sequence[View],
        dt_s: float,
        turn: int,
        learn_shape: bool,
        terms: Sequence[PoseTerm] = (),
    ) -> tuple[Fit, tuple[str, ...]]:
        """A better fit, if another pose of an uncertain arm gives one, and the sides that changed.

        turn: a running number; each turn tries another part of the low-discrepancy sets; terms: of every fit.
        """
        p = self.params
        if not any(is_uncertain(side, fit, p) for side in self.arms):
            return fit, ()
        changed = []
        empty = p.empty_narrow if self.fitter.is_narrow(fit.state, views) else p.empty
        for side, arm in self.arms.items():
            if not is_uncertain(side, fit, p):
                continue
            tries = candidates(
                self.fitter, fit.state, arm, views,
                part(self._cloud, turn, p.arm_cloud), part(self._library[side], turn, p.arm_library),
            )  # fmt: skip
            reaching = reaching_poses(self.fitter, fit.state, arm, views, p.arm_reaches, turn)
            tries = np.concatenate([tries, reaching])
            scores = score_arm_poses(self.fitter, fit.state, arm, views, tries, p.farther_px, empty)
            scores -= p.unusual_px * unusualness(tries, self._usual[side])
            scores += p.hand_px * score_hand_places(
                self.fitter, fit.state, arm, views, tries, empty
            )
            here = tries[0]
            best, least = fit, self._cost(arm, fit, here, views, empty) - p.arm_gain
            for n in best_poses(tries[:, 1:], scores, p.arm_fits):
                local = fit.state.local_xyzw.copy()
                local[arm.chain[:3]] = tries[n]
                state = replace(fit.state, local_xyzw=local)
                other = self.fitter.fit(state, views, dt_s, 3, learn_shape, fine=1, terms=terms)
                cost = self._cost(arm, other, here, views, empty)
                if cost < least:
                    best, least = other, cost
            if best is not fit:
                fit = best
                changed.append(side)
        return fit, tuple(changed)

    def _cost(
        self, arm: Arm, fit: Fit, here_xyzw: Floats, views: Sequence[View], empty: float
    ) -> float:
        """Of a fit, with what its pose of an arm (3,4) costs beside what the pictures say, and its hand."""
        there = fit.state.local_xyzw[arm.chain[:3]]
        price = self._price(arm.side, there, here_xyzw)
        return fit.cost_for_any_pose + price - self._hand_px(arm, fit, views, empty)

    def _hand_px(self, arm: Arm, fit: Fit, views: Sequence[View], empty: float) -> float:
        """How much of the hand is seen where this fit has it, in the measure of its cost."""
        if self.params.hand_cost == 0.0:
            return 0.0
        pose = fit.state.local_xyzw[arm.chain[:3]][None]
        seen_px = score_hand_places(self.fitter, fit.state, arm, views, pose, empty)
        return self.params.hand_cost * float(seen_px[0])

    def _price(self, side: str, there_xyzw: Floats, here_xyzw: Floats) -> float:
        """What a pose (3,4) of an arm costs beside what the pictures say: it is seldom seen, or far from here."""
        p = self.params
        unusual = float(unusualness(there_xyzw[None], self._usual[side])[0])
        away_rad2 = float(turned_rad2(there_xyzw[None, 1:], here_xyzw[1:])[0])
        return p.unusual_cost * unusual + p.farther_px * away_rad2


def is_uncertain(side: str, fit: Fit, params: LimbSearchParams) -> bool:
    """Whether too little of an arm is confirmed by the pictures, or they show what only an arm can be."""
    return fit.confirmed_arms[side] < params.uncertain_arm or fit.nearer_px > params.nearer_px


def part(rows: Floats, turn: int, size: int) -> Floats:
    """As many of the rows (N,...), others each turn."""
    first = (turn * size) % len(rows)
    return rows[first : first + size]


def spread(size: int) -> Floats:
    """The first `size` points (size,6) of the Halton sequence, without the origin (Halton 1960)."""
    out = np.zeros((size, 6))
    for column, base in enumerate((2, 3, 5, 7, 11, 13)):
        n, f = np.arange(1, size + 1), 1.0
        while n.any():
            f /= base
            out[:, column] += f * (n % base)
            n //= base
    return out
