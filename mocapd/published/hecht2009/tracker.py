"""The published tracker without a shirt: a mass-spring body below a tracked head, with particle filters for the limbs.

Hecht, Azad and Dillmann, Markerless Human Motion Tracking with a Flexible Model and Appearance Learning, ICRA 2009.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.body.shape import BodyShape, mean_shape
from mocapd.body.skeleton import joint_positions
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_params import TICK_S
from mocapd.published.hecht2009.cylinders.limb_particles import LimbCloud, step_cloud
from mocapd.published.hecht2009.cylinders.limb_score import LimbView
from mocapd.published.hecht2009.cylinders.part_colours import learn, reference_colours
from mocapd.published.hecht2009.edge_penalties import PARTS, edge_penalties, mean_edge_penalty
from mocapd.published.hecht2009.evidence import RigEvidence
from mocapd.published.hecht2009.face.lbp_cascade import frontal_faces
from mocapd.published.hecht2009.hanging_body import HangingBody, hang
from mocapd.published.hecht2009.head.head_track import HeadState, HeadTrack
from mocapd.published.hecht2009.head.head_tracker import HeadTracker
from mocapd.published.hecht2009.limb_clouds import clouds_about, clouds_at
from mocapd.published.hecht2009.mass_spring.body_points import LIMBS, N_POINTS
from mocapd.published.hecht2009.mass_spring.frusta import NAMES
from mocapd.published.hecht2009.mass_spring.mass_spring_body import build_body
from mocapd.published.hecht2009.mass_spring.simulation import (
    MassSpringState,
    confident_masses,
    head_middle,
    project_limb,
    project_onto_constraints,
    resting,
    simulate,
    with_head,
    with_points,
)
from mocapd.published.hecht2009.mass_spring.skeleton_conversion import (
    points_from_skeleton,
    skeleton_from_points,
)
from mocapd.published.hecht2009.params import FLOOR_M, Params
from mocapd.published.hecht2009.part_confidence import joint_confidence, joint_uncertainty_m
from mocapd.published.hecht2009.part_samples import PartSamples
from mocapd.published.hecht2009.stances import stances_of
from mocapd.published.hecht2009.upright_head import UprightHead, find_upright_head
from mocapd.tracking.base import Probe, Track, lost_body, no_probe, require_stature
from mocapd.tracking.tracking_state import (
    TrackingState,
    TrackingStateParams,
    confidence_fade,
    grow_uncertainty,
)
from mocapd.types import BodyState, Floats, FrameSet, Rig, Tracking

_NEVER_S = 1e9


@dataclass(frozen=True, slots=True, eq=False)
class _TrackedPerson:
    """State of a tracked person. head_sd_m: of the head's position; samples: of the parts, by foreground; quality: 0..1."""

    t_ns: int
    state: MassSpringState
    clouds: dict[str, LimbCloud]
    head_sd_m: float
    samples: PartSamples
    quality: float
    cameras: tuple[str, ...]


class Hecht2009Tracker:
    """For two or more calibrated cameras with the whole person in view; contract: `mocapd.tracking.base.Tracker`."""

    name = "hecht2009"

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        params: Params | None = None,
        tracking: TrackingStateParams | None = None,
    ) -> None:
        self.params = p = params if params is not None else Params()
        self.rig = rig
        self._stature_m = stature_m
        self._body = build_body(mean_shape(stature_m))
        self._views = RigEvidence(rig, p)
        self._head = HeadTracker(rig.cameras, stature_m, frontal_faces(), p.seed)
        self._tracking = TrackingState(tracking)
        self.probe: Probe = no_probe
        self.reset()

    def reset(self, near: BodyState | None = None) -> None:
        """Reset pose, background and appearance. near: a body to continue from."""
        self._views.reset()
        self._head.reset()
        self._tracking.reset(None if near is None or near.pose is None else near.t_ns)
        self._rng = np.random.default_rng(self.params.seed)
        self._near = near
        self._hanging: HangingBody | None = None
        self._upright_head: UprightHead | None = None
        self._person: _TrackedPerson | None = None
        self._last_ns: int | None = None
        self._turn = 0

    def step(self, frames: FrameSet, shape: BodyShape) -> Track:
        """Track one frame set. Raises ConfigError when a frame's size is not its calibration's."""
        require_stature(shape, self._stature_m)
        if not np.array_equal(shape.factors, self._body.shape.factors):
            self._body = build_body(shape)
        self._turn += 1
        since_s = _NEVER_S if self._last_ns is None else seconds(frames.t_ns - self._last_ns)
        self._last_ns = frames.t_ns
        if since_s > self.params.too_old_s:
            self._hanging = self._person = None
            self._head.reset()
            since_s = TICK_S  # there is no state to predict over the gap
        dt_s = float(np.clip(since_s, 1e-3, self.params.too_old_s))
        self._views.look(frames)
        self.probe("picture")
        person = self._person
        evidence = False
        if self._near is not None and self._views.present:
            person, self._near = self._taken_over(self._near, frames), None
        self._mark(None if person is None else person.state.points_m)
        for view in self._views.present:
            view.update_foreground(self._turn % self.params.uncovered_turns == 0)
        self.probe("background")
        head = self._head.step([view.head_picture() for view in self._views.each], dt_s)
        head = self._or_upright(head, dt_s)
        self.probe("head")
        if head.state is HeadState.TRACKED and self._views.present:
            if person is None:
                person = self._match(head, dt_s, frames)
            if person is not None:
                updated = self._follow(person, head, dt_s, frames)
                evidence = updated is not None
                person = updated if updated is not None else person
        elif person is None:
            self._hanging = None
        tracking = self._tracking.step(frames.t_ns, evidence)
        if tracking is Tracking.LOST and not evidence:
            person = None
        self._person = person
        self._learn_background()
        self.probe("learn")
        return self._track(tracking, frames, shape)

    # --- starting ---

    def _or_upright(self, head: HeadTrack, dt_s: float) -> HeadTrack:
        """The tracked head, or else that of an upright figure."""
        if head.state is not HeadState.LOST or self._person is not None:
            self._upright_head = None
            return head
        self._upright_head = find_upright_head(
            self._views.present, self._upright_head, self._stature_m
        )
        if self._upright_head is not None and self._upright_head.is_sure:
            self._head.reset(self._upright_head.middle_m)
            self._upright_head = None
            return self._head.step([view.head_picture() for view in self._views.each], dt_s)
        return head

    def _match(self, head: HeadTrack, dt_s: float, frames: FrameSet) -> _TrackedPerson | None:
        """A body that hangs from the head, if the pictures match it."""
        p = self.params
        cameras = [view.camera for view in self._views.present]
        hanging = hang(self._hanging, self._body, head, dt_s, cameras, p)
        self._hanging = hanging
        points = hanging.state.points_m
        self._mark(points)
        stances = stances_of(self._body, points, p.raised_rad)
        views = self._limb_views()
        frusta = self._body.frusta
        edges = {
            limb: edge_penalties(frusta, limb, some, views, p.score)
            for limb, some in stances.items()
        }
        best = {limb: some[int(np.argmin(edges[limb]))] for limb, some in stances.items()}
        for limb, which in LIMBS.items():
            points = with_points(resting(points), which, best[limb]).points_m
        state = project_onto_constraints(self._body, resting(points), None, FLOOR_M, p.simulation)
        samples = self._samples(state.points_m)
        self.probe("match")
        edge = float(np.mean([some.min() for some in edges.values()]))
        if edge > p.match_edge or samples.body_share() < p.match_before:
            return None
        self._hanging = None
        self._views.forget_person()
        clouds = clouds_at(state.points_m, len(self._views.each), p)
        return _TrackedPerson(
            frames.t_ns, state, clouds, head.sigma_along_m, samples, 1.0 - edge, ()
        )

    def _taken_over(self, near: BodyState, frames: FrameSet) -> _TrackedPerson | None:
        """Start from another tracker's body, with the picture outside it as background. The next look tests it."""
        p, pose = self.params, near.pose
        if pose is None or abs(frames.t_ns - near.t_ns) > nanoseconds(p.too_old_s):
            return None
        state = resting(points_from_skeleton(self._body, pose))
        self._mark(state.points_m)
        for view in self._views.present:
            view.seed_background()
        self._head.reset(head_middle(self._body, state))
        age_s = max(seconds(frames.t_ns - near.t_ns), 0.0)
        uncertainty_m = grow_uncertainty(near.uncertainty_m, age_s)
        clouds = clouds_about(state.points_m, uncertainty_m, len(self._views.each), self._rng, p)
        samples = PartSamples.none(len(NAMES))
        return _TrackedPerson(frames.t_ns, state, clouds, 0.05, samples, 0.0, ())

    # --- following ---

    def _follow(
        self, person: _TrackedPerson, head: HeadTrack, dt_s: float, frames: FrameSet
    ) -> _TrackedPerson | None:
        """One frame of tracking [Hecht 2009, section III]; None if the pictures do not confirm the body."""
        p, body = self.params, self._body
        assert head.middle_m is not None
        state = with_head(body, person.state, head.middle_m, p.simulation)
        state = simulate(body, state, dt_s, floor_m=FLOOR_M, params=p.simulation)
        self._mark(state.points_m)
        self.probe("simulation")
        self._learn_appearance(person.clouds, dt_s)
        views = self._limb_views()
        self.probe("appearance")
        clouds, spread = {}, np.full(N_POINTS, np.inf)
        guided = state
        for limb, which in LIMBS.items():
            cloud = self._limb(limb, person.clouds[limb], state.points_m, views, dt_s)
            clouds[limb] = cloud
            spread[list(which)] = np.sqrt(cloud.variance_m2)
            guided = with_points(guided, which, cloud.mean_m)
        self.probe("particles")
        masses = confident_masses(body.mass_kg, spread)
        state = project_onto_constraints(body, guided, masses, FLOOR_M, p.simulation)
        edge = mean_edge_penalty(body.frusta, state.points_m, self._limb_views(), p.score)
        samples = self._samples(state.points_m)
        self.probe("projection")
        share = samples.body_share()
        if edge > p.most_edge or share < p.least_before:
            return None
        names = tuple(view.camera.name for view in self._views.present)
        quality = float(np.clip((1.0 - edge) * share, 0.0, 1.0))
        return _TrackedPerson(
            frames.t_ns, state, clouds, head.sigma_along_m, samples, quality, names
        )

    def _limb(
        self, limb: str, cloud: LimbCloud, points_m: Floats, views: Sequence[LimbView], dt_s: float
    ) -> LimbCloud:
        p, parts = self.params, PARTS[limb]

        def constrain(particles_m: Floats) -> Floats:
            return project_limb(
                self._body, limb, particles_m, points_m, None, FLOOR_M, params=p.simulation
            )

        return step_cloud(
            cloud, dt_s, self._body.frusta.radii_m[list(parts)], parts, views,
            constrain if p.particle_constraints else None, self._rng, p.motion, p.score,
        )  # fmt: skip

    def _learn_appearance(self, clouds: dict[str, LimbCloud], dt_s: float) -> None:
        """Update the running average of the parts' colours, weighted by the confidence of each end."""
        p, views = self.params, self._views
        if not p.score.appearance or views.appearance.is_fixed:
            return
        sure = np.ones((len(NAMES), 2))
        for limb, (upper, lower) in PARTS.items():
            at = np.exp(-np.sqrt(clouds[limb].variance_m2) / p.sure_m)
            sure[upper], sure[lower] = at[:2], at[1:]
        for view in views.present:
            views.appearance = learn(views.appearance, view.index, view.ring_colours(), sure, dt_s)

    # --- evidence ---

    def _mark(self, points_m: Floats | None) -> None:
        """Marks the body in every present picture."""
        ends = None if points_m is None else self._body.frusta.ends_m(points_m)
        for view in self._views.present:
            view.mark_body(ends, self._body.frusta.radii_m)

    def _limb_views(self) -> list[LimbView]:
        reference = reference_colours(self._views.appearance, self.params.score.along)
        return [view.limb_view(reference[view.index]) for view in self._views.present]

    def _samples(self, points_m: Floats) -> PartSamples:
        return self._views.count_samples(self._body.frusta.ends_m(points_m))

    def _learn_background(self) -> None:
        """Update the backgrounds outside the body, or everywhere without one."""
        person, views = self._person, self._views.present
        if person is not None:
            self._mark(person.state.points_m)
        else:
            self._mark(None)
            if self._turn % self.params.absorb_turns:
                for view in views:
                    view.mark_unknown()
        for view in views:
            view.learn_background()

    # --- result ---

    def _track(self, tracking: Tracking, frames: FrameSet, shape: BodyShape) -> Track:
        person = self._person
        if tracking is Tracking.LOST or person is None:
            return Track(lost_body(frames.t_ns, self.name), shape)
        away_s = seconds(frames.t_ns - person.t_ns)
        pose = skeleton_from_points(self._body, person.state.points_m)
        spread = np.full(N_POINTS, np.inf)
        for limb, which in LIMBS.items():
            spread[list(which)] = np.sqrt(person.clouds[limb].variance_m2)
        uncertainty_m = joint_uncertainty_m(spread, person.head_sd_m)
        body = BodyState(
            t_ns=frames.t_ns,
            tracking=tracking,
            tracker=self.name,
            pose=pose,
            joints_m=joint_positions(self._body.skeleton, pose),
            confidence=joint_confidence(person.samples.confirmed_shares(), uncertainty_m)
            * confidence_fade(away_s),
            cameras=person.cameras if away_s == 0.0 else (),
            uncertainty_m=grow_uncertainty(uncertainty_m, away_s),
        )
        return Track(body, shape, person.quality * confidence_fade(away_s))
