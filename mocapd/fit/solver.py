"""Fit pose and body shape to the classified pictures of all cameras at once, by Gauss-Newton.

Every iteration renders the body's id map into each camera at that camera's own instant, gathers
the rows of `CameraRows`, adds the priors and solves one small normal equation.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property, partial
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from mocapd.body.areas import ARM_AREAS, N_AREAS
from mocapd.body.arrays import PosedJoints, plain
from mocapd.body.model import BodyModel
from mocapd.body.posing_kernels import forward_kinematics
from mocapd.body.shaping import Shaped, Shaper
from mocapd.body.skeleton import N_JOINTS
from mocapd.each import Each, in_turn
from mocapd.fit.body_drawing import IdMapRenderer, Roi
from mocapd.fit.collision_kernels import TorsoSlices, push_arms_out
from mocapd.fit.collision_term import TorsoHull, arm_chains
from mocapd.fit.depth_agreement_kernels import compare_depths
from mocapd.fit.fit_params import FitParams
from mocapd.fit.idmap_term import CameraRows, search_within
from mocapd.fit.idmap_term_kernels import ComparedPictures, Search
from mocapd.fit.motion_state import MotionState, moved, stepped
from mocapd.fit.nearest_pixel_kernels import offsets_by_distance
from mocapd.fit.pose_prior import narrow_prior, wide_prior
from mocapd.fit.positive_inverse import positive_inverse
from mocapd.fit.seen_depth import GRID_PX
from mocapd.fit.step_kernels import gauss_newton_step
from mocapd.fit.surface_labels import SurfaceLabels
from mocapd.fit.terms.pose_term import PoseTerm
from mocapd.types import Camera, Floats, Ints

_CONFIRMED, _CONFIRMED_PX = 0.4, 4.0  # share and number of the rendered pixels
_IN_SIGHT = 0.10  # an arm in sight takes at least this share of all that is visible
_NO_PIXELS = np.zeros(N_AREAS)


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One camera's evidence: ids and pixel_weight (h,w) over `roi`, taken dt_s after the asked instant; bare (h,w):
    where skin may be, when that was looked for; depth_m (h,w): of what is seen, along the camera's axis [m], NaN where
    that is not known."""

    index: int
    roi: Roi
    ids: NDArray[np.uint8]
    pixel_weight: NDArray[np.uint8]
    dt_s: float
    bare: NDArray[np.bool_] | None = None
    depth_m: NDArray[np.float32] | None = None


@dataclass(frozen=True, eq=False)  # no slots: a cached property is kept in __dict__
class Fit:
    """The fitted state; by area (A,) the rendered, matched and wrongly placed pixels; H (P,P): the
    information of the evidence alone on pose and shape; information (n_pose,n_pose): with what was known before;
    in_depth (A,): share of an area's pixels that are where depths are seen, 1 where none are; nearer_px: where something is
    seen well before all that is drawn; measured_cost: what the cost has of terms that were measured for another pose."""

    state: MotionState
    visible: Floats
    matched: Floats
    unexplained: Floats
    H: Floats
    cost: float
    information: Floats
    in_depth: Floats = field(default_factory=partial(np.ones, N_AREAS))
    nearer_px: float = 0.0
    measured_cost: float = 0.0

    @cached_property
    def covariance(self) -> Floats:
        """Of the pose (n_pose,n_pose), as the pictures and what was known before leave it."""
        return positive_inverse(self.information)

    @cached_property
    def visible_px(self) -> float:
        """All that was rendered."""
        return float(self.visible.sum())

    @cached_property
    def match(self) -> float:
        """Share of the rendered pixels whose label the pictures have."""
        return float(self.matched.sum() / max(self.visible_px, 1.0))

    @cached_property
    def explained(self) -> float:
        """Share of rendered and of wrongly placed picture pixels that agree: harder than `match`."""
        return float(self.matched.sum() / max(self.visible_px + self.unexplained.sum(), 1.0))

    @property
    def cost_for_any_pose(self) -> float:
        """Its cost where poses far from each other are compared."""
        return self.cost - self.measured_cost

    @cached_property
    def confirmed_arms(self) -> dict[str, float]:
        """0..1 by side: share of an arm that the pictures confirm; one out of sight is not."""
        in_sight = _IN_SIGHT * self.visible_px
        confirmed = {}
        for side, p in ARM_AREAS.items():
            asked = self.visible[p].sum() + self.unexplained[p].sum()
            confirmed[side] = float(
                (self.matched * self.in_depth)[p].sum() / (max(asked, in_sight) + 1.0)
            )
        return confirmed


def confirmed_parts(matched: Floats | Ints, visible: Floats | Ints) -> NDArray[np.bool_]:
    """Of which areas, or labels, so much of what is rendered is seen that it cannot be chance."""
    return (matched >= _CONFIRMED_PX) & (matched >= _CONFIRMED * visible)


@dataclass(frozen=True, slots=True, eq=False)
class _Pass:
    """What is the same for all cameras in one iteration."""

    state: MotionState
    body: Shaped
    search: Search
    n_shape: int
    redraw: bool


def _coarse(view: View) -> View:
    """Every second pixel each way."""
    ids, pixel_weight = view.ids[::2, ::2].copy(), view.pixel_weight[::2, ::2].copy()
    return View(view.index, view.roi, ids, pixel_weight, view.dt_s)


class Fitter:
    """Buffers and constants for fitting one body in one rig; holds no state between calls."""

    def __init__(
        self,
        model: BodyModel,
        labels: SurfaceLabels,
        cameras: Sequence[Camera],
        image_scales: Sequence[int],
        params: FitParams,
        each: Each = in_turn,
    ) -> None:
        """labels: of the pictures' pixels; image_scales: by how much each camera's frames are averaged down."""
        self.model, self.labels, self.params, self.each = model, labels, params, each
        self.shaper = Shaper(model)
        self.drawings = [
            IdMapRenderer(self.shaper, labels, c, f)
            for c, f in zip(cameras, image_scales, strict=True)
        ]
        self._from_eyes_m = [c.R.T @ c.t_m for c in cameras]
        self._rows = [CameraRows(model) for _ in cameras]
        self.arms = arm_chains(model)
        self._plain_arms = plain(self.arms)
        self._hull = TorsoHull.of(model)
        self._torso: tuple[Shaped, TorsoSlices] | None = None
        self._offsets = offsets_by_distance(params.first_radius_px)
        self._offsets_r2 = (self._offsets**2).sum(axis=1)
        self._search = cache(self._searched)
        p = params
        self.prediction_sd = np.concatenate([
            np.full(3, p.root_sd_m),
            model.space.by_group({
                "hips": (p.hips_sd_rad,) * 3, "spine": (p.spine_sd_rad,) * 3,
                "leftShoulder": (p.collar_sd_rad,) * 3, "rightShoulder": (p.collar_sd_rad,) * 3,
                "leftUpperArm": (p.arm_sd_rad,) * 3, "rightUpperArm": (p.arm_sd_rad,) * 3,
            }, p.arm_sd_rad),
        ])  # fmt: skip
        self._wide, self._narrow = plain(wide_prior(model, p)), plain(narrow_prior(model, p))

    def joints(self, state: MotionState) -> tuple[Floats, Floats]:
        """Joint centres (J,3) and global rotations (J,4) of a state."""
        rest = self.shaper(state.factors).rest
        R, joints = np.empty((N_JOINTS, 3, 3)), np.empty((N_JOINTS, 3))
        quats = np.empty((N_JOINTS, 4))
        forward_kinematics(
            self.model.parents, rest, state.root_m, state.local_xyzw, R, joints, quats
        )
        return joints, quats

    def torso(self, body: Shaped) -> TorsoSlices:
        """The trunk of a body, for collisions."""
        known = self._torso
        if known is None or known[0] is not body:
            known = self._torso = body, self._hull.sized(body)
        return known[1]

    def fit(
        self,
        prediction: MotionState,
        views: Sequence[View],
        dt_s: float,
        iterations: int,
        learn_shape: bool,
        rendered: bool = False,
        fine: int | None = None,
        motion: Floats | None = None,
        terms: Sequence[PoseTerm] = (),
    ) -> Fit:
        """Fit all views, starting at and held loosely to `prediction`, dt_s after the last fit.

        rendered: the prediction was drawn last into every view, so that the first iteration need
        not draw it again. fine: how many of the iterations, the last ones, look at all pixels
        (None: as many as the parameters say). motion (n_pose,n_pose): information of
        the prediction; None for the usual, loose one. terms: what else holds or pulls the pose.
        """
        p, m, n_pose = self.params, self.model, self.model.n_pose
        state, crowded, measured = prediction, 0.0, 0.0
        if motion is None:
            motion = np.diag(1.0 / (self.prediction_sd**2 * max(dt_s * 30.0, 0.5)))
        fine = p.fine_iterations if fine is None else fine
        priors = self._narrow if self.is_narrow(prediction, views) else self._wide
        H = held = np.zeros((n_pose, n_pose))
        torso = plain(self.torso(self.shaper(state.factors)))
        coarse = [_coarse(view) for view in views]
        for iteration in range(iterations):
            along = iteration / max(iterations - 1, 1)
            radius = p.first_radius_px + along * (p.last_radius_px - p.first_radius_px)
            is_fine = iteration >= iterations - fine
            # proportions are a matter of a few pixels
            n_shape = m.n_shape if learn_shape and is_fine else 0
            P = n_pose + n_shape
            one = _Pass(
                state,
                self.shaper(state.factors),
                self._search(radius, is_fine, iteration & 1),
                n_shape,
                redraw=not rendered or iteration > 0,
            )
            H = np.zeros((P, P))
            b = np.zeros(P)
            used = views if is_fine else coarse
            self.each(partial(self._gather, one), used)
            for view in used:
                mine = self._rows[view.index].system(P)
                H += mine[0]
                b += mine[1]
            held, pull = H.copy(), b.copy()
            posed = self._posed(state, one.body)
            _, R, joints, _ = posed
            crowded = push_arms_out(
                R,
                joints,
                m.parents,
                torso,
                self._plain_arms,
                p.collision_information,
                held,
                pull,
            )
            measured = 0.0
            for term in terms:
                cost = term.add(posed, one.body, held, pull)
                crowded += cost
                measured += cost if term.is_measured else 0.0
            step = gauss_newton_step(
                held, pull, state.root_m, state.local_xyzw, prediction.root_m, prediction.local_xyzw,
                motion, priors, prediction.factors - state.factors, prediction.information,
            )  # fmt: skip
            root, local = stepped(m, state.root_m, state.local_xyzw, step[:n_pose])
            factors = state.factors
            if n_shape:
                factors = np.clip(factors + step[n_pose:], 0.6, 1.6)
            state = MotionState(root, local, state.velocity, factors, state.information)
        rows = [self._rows[view.index] for view in views]
        misplaced, in_depth, nearer_px = self._compare_depths(views)
        return Fit(
            state,
            sum((r.visible for r in rows), _NO_PIXELS),
            sum((r.matched for r in rows), _NO_PIXELS),
            sum((r.unexplained for r in rows), _NO_PIXELS),
            H,
            sum(r.cost for r in rows) + crowded + misplaced,
            held[:n_pose, :n_pose] + motion,
            in_depth,
            nearer_px,
            measured,
        )

    def _compare_depths(self, views: Sequence[View]) -> tuple[float, Floats, float]:
        """The cost of what was drawn last nearer or farther than it is seen; by area whether it is there (A,); and the
        pixels in which something is seen well before what was drawn."""
        if all(view.depth_m is None for view in views):
            return 0.0, np.ones(N_AREAS), 0.0
        p, cost, nearer_px = self.params, 0.0, 0.0
        asked, off = np.zeros(N_AREAS), np.zeros(N_AREAS)
        for view in views:
            if view.depth_m is not None:
                drawing = self.drawings[view.index]
                away, nearer = compare_depths(
                    drawing.last_depth_m(view.roi), drawing.last(view.roi)[1], self.labels.area, view.depth_m,
                    GRID_PX, p.depth_around_px, p.depth_off_m, asked, off,
                )  # fmt: skip
                cost += p.depth_cost * away
                nearer_px += nearer
        share = np.minimum(p.depth_usual * (1.0 - off / np.maximum(asked, 1.0)), 1.0)
        return cost, np.where(asked >= p.depth_least_px, share, 1.0), nearer_px

    def is_narrow(self, state: MotionState, views: Sequence[View]) -> bool:
        """Whether all cameras see the body from about the same side."""
        rays = [state.root_m + self._from_eyes_m[view.index] for view in views]
        least = np.cos(self.params.narrow_rad)
        return bool(views) and all(
            a @ b > least * np.sqrt((a @ a) * (b @ b)) for a, b in combinations(rays, 2)
        )

    def _posed(self, state: MotionState, body: Shaped) -> PosedJoints:
        """At the frame set's own instant."""
        R, joints = np.empty((N_JOINTS, 3, 3)), np.empty((N_JOINTS, 3))
        posed = PosedJoints(body.rest, R, joints, np.empty((N_JOINTS, 4)))
        forward_kinematics(
            self.model.parents, body.rest, state.root_m, state.local_xyzw, R, joints, posed.quats
        )
        return posed

    def _gather(self, one: _Pass, view: View) -> None:
        """The rows of one camera."""
        m, state, coarse = self.model, one.state, one.search.grid_px > 1.0
        drawing, rows = self.drawings[view.index], self._rows[view.index]
        root, local = moved(m, state, view.dt_s)
        if one.redraw:
            draw = drawing.draw_coarse if coarse else drawing.draw
            drawn = draw(root, local, one.body, view.roi)
        else:
            drawn = drawing.last_coarse(view.roi) if coarse else drawing.last(view.roi)
            drawing.pose(root, local, one.body.rest)
        rows.gather(
            drawing, one.body, ComparedPictures(*drawn, view.ids, view.pixel_weight), one.search,
            one.n_shape, self.params.row_weight,
        )  # fmt: skip

    def _searched(self, radius_px: float, fine: bool, phase: int) -> Search:
        """Half of all pixels, or, not `fine`, a quarter: every second each way."""
        grid_px = 1.0 if fine else 2.0
        n = np.searchsorted(self._offsets_r2, (radius_px / grid_px) ** 2, side="right")
        return search_within(
            self._offsets[:n], radius_px, grid_px,
            every=2 if fine else 1, phase=phase, edge_weight=self.params.edge_weight if fine else 0.0,
        )  # fmt: skip

    def shape_information(self, H: Floats) -> Floats:
        """What the evidence says of the shape factors when the pose is free: Schur complement (n_shape,n_shape)."""
        n = self.model.n_pose
        Hpp = H[:n, :n] + self._wide[1] + 1e-3 * np.eye(n)
        Hps = H[:n, n:]
        return H[n:, n:] - Hps.T @ np.linalg.solve(Hpp, Hps)
