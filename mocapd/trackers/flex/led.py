"""What another tracker knows of the body: taken over as a whole, or its upper body held while legs and head are fitted."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.body.pose_space import upper_body
from mocapd.body.regions import Region
from mocapd.body.skeleton import N_JOINTS, local_from_global
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.motion_state import MotionState, gone_on, moved
from mocapd.fit.solver import Fit, Fitter, View
from mocapd.fit.terms.joint_term import JointRays
from mocapd.fit.terms.pose_term import PoseTerm
from mocapd.geometry import rotations
from mocapd.trackers.base import Probe
from mocapd.trackers.flex.camera_views import CameraViews
from mocapd.trackers.flex.joint_views import unwatched
from mocapd.trackers.flex.memory import Followed, Proportions, is_believed, velocity_of
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.pose_terms import PoseTerms
from mocapd.trackers.flex.rescue.other_poses import OtherPoses
from mocapd.trackers.flex.rescue.seen_tries import Anew
from mocapd.trackers.flex.wardrobe import Wardrobe
from mocapd.types import Floats, FrameSet, Pose, Skeleton

TAKEN_OVER_S = 0.1  # another tracker's body is held as loosely as a prediction over this time
LEGS = (Region.LEG, Region.FOOT)  # regions that a guide does not know
_UPPER = np.flatnonzero(upper_body().group_of_joint >= 0)  # joints that a guide knows


def taken_over(
    model: BodyModel, skeleton: Skeleton, pose: Pose, wearer: Proportions
) -> MotionState:
    """Another tracker's body, at rest."""
    local = local_from_global(skeleton, pose.quats_xyzw)
    still = np.zeros(model.n_pose)
    return MotionState(pose.root_m.copy(), local, still, wearer.factors, wearer.information)


def standing_below(model: BodyModel, upper: Pose, wearer: Proportions) -> MotionState:
    """Somebody with this upper body whose legs hang straight down."""
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    still = np.zeros(model.n_pose)
    return MotionState(upper.root_m, local, still, wearer.factors, wearer.information)


def predicted_below(
    model: BodyModel,
    skeleton: Skeleton,
    params: Params,
    last: MotionState,
    dt_s: float,
    upper: Pose,
    wearer: Proportions,
) -> MotionState:
    """The upper body as the guide has it, legs and head where they have gone since the last state."""
    local = moved(model, last, dt_s, params.prediction_damping)[1]
    local[_UPPER] = local_from_global(skeleton, upper.quats_xyzw)[_UPPER]
    return MotionState(
        upper.root_m.copy(), local, last.velocity, wearer.factors, wearer.information
    )


def guided_information(params: Params, prediction_sd: Floats, dt_s: float) -> Floats:
    """Of the prediction (n_pose,n_pose): the guide's part is held, the others as loosely as usual, by their standard
    deviations (n_pose,) in a tick."""
    held = np.zeros(len(prediction_sd))
    held[:3] = params.guided_sd_m**-2
    held[3 : upper_body().n_pose] = params.guided_sd_rad**-2
    return np.diag(held + 1.0 / (prediction_sd**2 * max(dt_s / TICK_S, 0.5)))


class _Ready(NamedTuple):
    """What was made of the pictures of one frame set before the guide was known: as `drawn`, the body as it goes on from the
    last ones."""

    frames: FrameSet
    drawn: MotionState
    views: list[View]
    rays: list[JointRays | None]


class _Guided(NamedTuple):
    """One frame set, and what is known before it is looked at."""

    predicted: MotionState
    frames: FrameSet
    turn: int
    dt_s: float
    held: Floats
    iterations: int


class _Found(NamedTuple):
    """What came of it, and the parts of the body that were found elsewhere."""

    fit: Fit
    views: list[View]
    changed: tuple[str, ...] = ()


class LegsBelow:
    """Legs below, and a head above, an upper body that another tracker leads. Remembers since when it knows the legs."""

    def __init__(
        self,
        params: Params,
        skeleton: Skeleton,
        cameras: CameraViews,
        wardrobe: Wardrobe,
        silhouettes: Fitter,
        terms: PoseTerms,
        others: OtherPoses,
    ) -> None:
        """silhouettes: a fitter whose body is of one colour. The rest is shared with whoever tracks without a guide."""
        self._params, self._skeleton, self._silhouettes = params, skeleton, silhouettes
        self._cameras, self._wardrobe = cameras, wardrobe
        self._terms, self._others = terms, others
        self.reset()

    def reset(self) -> None:
        """No legs were seen."""
        self._ready: _Ready | None = None
        self._found_ns = -nanoseconds(self._params.guided_joint_after_s)

    def prepare(self, known: Followed, frames: FrameSet, turn: int) -> None:
        """Classify the pictures without a guide, if the wearer's look is known."""
        cameras = self._cameras
        if not cameras.are_new and cameras.know_appearance:
            dt_s = max(seconds(frames.t_ns - known.t_ns), 1e-3)
            drawn = gone_on(
                self._silhouettes.model, known.state, dt_s, self._params.prediction_damping
            )
            views, rays = cameras.prepared(drawn, turn, self._watch(drawn, frames, turn))
            self._ready = _Ready(frames, drawn, views, rays)

    def follow(
        self,
        known: Followed | None,
        upper: Pose,
        wearer: Proportions,
        frames: FrameSet,
        turn: int,
        probe: Probe,
    ) -> tuple[Followed | None, list[View]]:
        """One frame; one without evidence leaves `known` at its old time."""
        p, cameras, model = self._params, self._cameras, self._silhouettes.model
        last = known.state if known is not None else standing_below(model, upper, wearer)
        dt_s = max(seconds(frames.t_ns - known.t_ns), 1e-3) if known is not None else TAKEN_OVER_S
        predicted = predicted_below(model, self._skeleton, p, last, dt_s, upper, wearer)
        if known is None:
            self._found_ns = frames.t_ns
        if cameras.are_new:
            cameras.mark_body(predicted)
            cameras.seed_background()
        # legs that were not seen before have a way to go
        iterations = p.guided_iterations if known is not None else p.start.iterations
        held = guided_information(p, self._wardrobe.fitter.prediction_sd, dt_s)
        one = _Guided(predicted, frames, turn, dt_s, held, iterations)
        found = self._fitted(one, probe) if cameras.know_appearance else self._outlined(one)
        if found is None or not is_believed(found.fit, p):
            return known, [] if found is None else found.views
        velocity = np.zeros(model.n_pose)
        if known is not None:
            velocity = velocity_of(model, p, found.fit, last, dt_s, found.changed)
        state = replace(found.fit.state, velocity=velocity)
        names = cameras.names(found.views)
        return Followed(frames.t_ns, state, found.fit, names, found.changed), found.views

    def _outlined(self, one: _Guided) -> _Found | None:
        """Somebody whose look is not known yet, by what stands before the background; it is learned then."""
        p, cameras = self._params, self._cameras
        cameras.mark_body(one.predicted)
        cameras.renew_before(one.turn)
        views = cameras.silhouettes(one.predicted)
        if not views:
            return None
        fit = self._silhouettes.fit(
            one.predicted, views, one.dt_s, one.iterations, learn_shape=False, fine=1, motion=one.held,
            terms=(self._terms.floor,),
        )  # fmt: skip
        if fit.explained >= p.learn_explained:
            self._wardrobe.learn_first(fit.state, cameras)
        return _Found(fit, views)

    def _fitted(self, one: _Guided, probe: Probe) -> _Found | None:
        """Somebody whose look is known."""
        fitter, terms = self._wardrobe.fitter, self._terms
        ready, self._ready = self._ready, None
        if ready is not None and ready.frames is one.frames:
            _, drawn, views, rays = ready
        else:
            drawn = one.predicted
            watch = self._watch(drawn, one.frames, one.turn)
            views, rays = self._cameras.prepared(drawn, one.turn, watch)
        probe("cameras")
        if not views:
            return None
        seen = terms.joints.term(fitter.model, rays)

        def terms_of(drawn: MotionState, shown: Sequence[View]) -> tuple[PoseTerm, ...]:
            return (*terms.measured(fitter, drawn, shown, one.frames, one.turn, LEGS), *seen)

        of_drawn = terms_of(drawn, views)
        probe("distances")
        fit = fitter.fit(
            one.predicted, views, one.dt_s, one.iterations, learn_shape=False, rendered=drawn is one.predicted, fine=1,
            motion=one.held, terms=of_drawn,
        )  # fmt: skip
        probe("fit")
        fit, views, changed = self._others.other_legs(
            self._wardrobe.dressed, fit, views, one.dt_s, one.turn, of_drawn, seen,
            Anew(self._cameras.classified, terms_of), one.held,
        )  # fmt: skip
        probe("legs")
        return _Found(fit, views, changed)

    def _watch(
        self, expected: MotionState, frames: FrameSet, turn: int
    ) -> Callable[[int], JointRays | None]:
        """What looks for joints, in the frames that do."""
        p = self._params
        # legs that were just found are told as found: what moves them far must wait
        is_new = frames.t_ns - self._found_ns <= nanoseconds(p.guided_joint_after_s)
        if turn % p.guided_joint_turns != 1 or is_new:
            return unwatched
        return self._terms.joints.watch(self._wardrobe.fitter, expected, self._cameras)
