"""The shirt as a cue: its patches classified in each picture place trunk and arms, and find the wearer from nothing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.model import BodyModel, build_model
from mocapd.body.pose_space import SIDES
from mocapd.body.skeleton import INDEX
from mocapd.clock import nanoseconds
from mocapd.each import Each, in_turn
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.fit_result import Fit
from mocapd.fit.idmap_renderer import Roi
from mocapd.fit.limbs.arm_search import ArmSearch, is_uncertain
from mocapd.fit.motion_state import MotionState, initial_information
from mocapd.fit.priors.motion_prior import prediction_prior
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.fit.work_size import image_scales
from mocapd.shirt.colour.colour_model import ColourModel
from mocapd.shirt.garment import confirmed_colours, shirt_labels
from mocapd.shirt.pose_database.database import PoseDatabase
from mocapd.shirt.segmentation.rig_segmenter import RigSegmenter
from mocapd.tracking.base import Probe
from mocapd.tracking.cues.shirt import shirt_search as detection
from mocapd.tracking.cues.shirt.shirt_params import ShirtParams
from mocapd.tracking.cues.stereo.stereo_distances import stereo_distance_terms
from mocapd.tracking.effort import OptionalWork
from mocapd.tracking.pictures import Pictures
from mocapd.tracking.ticks import Ticks
from mocapd.tracking.track_state import (
    NEW_BODY_PRIOR_S,
    BodyShapeEstimate,
    TrackState,
    t_pose_state,
    upper_body_state,
)
from mocapd.tracking.velocity import velocity_between
from mocapd.types import Bytes, Floats, Rig
from mocapd.vision.room_background import RoomBackground

_ARMS = [INDEX[side + bone] for side in SIDES for bone in ("UpperArm", "LowerArm", "Hand")]
_WITHOUT_ARMS = 0.5  # share of an acceptable match that a shirt's trunk has, however its arms are
_LONGEST_TICKS = 8  # after a pause no more is learned from a frame set than after so many


@dataclass(frozen=True, slots=True, eq=False)
class ShirtEstimate:
    """Trunk and arms from the shirt, with the views that show it.

    taught_s: see `BodyShapeEstimate`; jumped: sides whose arm was found away from its prediction; redraw: True if the
    last rendered body differs from the fit.
    """

    fit: Fit
    motion: MotionState
    views: tuple[View, ...]
    taught_s: float
    jumped: tuple[str, ...] = ()
    redraw: bool = True


class ShirtCue:
    """Keeps each camera's light, colours and background, and the time of the next search."""

    name = "shirt"

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        colours: ColourModel,
        white_balance: Mapping[str, Floats],
        database: PoseDatabase,
        params: ShirtParams | None = None,
        each: Each = in_turn,
        backgrounds: Sequence[RoomBackground] | None = None,
    ) -> None:
        """white_balance: W (3,3) by camera name, from strokes in the present light; identity where absent.
        backgrounds: of the cameras, where another cue learns them."""
        self.params = p = params if params is not None else ShirtParams()
        self._cameras, self._database = rig.cameras, database
        self.model: BodyModel = build_model(stature_m)
        smaller = image_scales(rig.cameras, p.fit.work_width_px)
        self.fitter = Fitter(
            self.model, shirt_labels(self.model), rig.cameras, smaller, p.fit, each
        )
        self.segmenters = RigSegmenter(
            self.fitter, colours, white_balance, p.segmentation, backgrounds
        )
        self._columns = {side: self.model.space.columns(f"{side}_arm") for side in SIDES}
        self._arms = ArmSearch(self.fitter, p.limbs)
        self.work = OptionalWork()
        self.reset()

    def rehearse(self) -> None:
        """Compile or load the kernels that only rare frames reach."""
        w, h = self.segmenters.each[0].size
        nothing = np.zeros((h, w), np.uint8)
        information = initial_information(self.model.space)
        wearer = BodyShapeEstimate(np.ones(self.model.n_shape), information, 0.0)
        body = t_pose_state(self.model, self.model.rest_m[0].copy(), wearer)
        self._arms.rehearse(body, [View(0, (0, 0, w, h), nothing, nothing, 0.0)])

    def reset(self) -> None:
        """Forget light and background."""
        self.segmenters.reset()
        self._next_search_ns = 0
        self._ticks = Ticks(1, 1, 1)

    def take(self, pictures: Pictures, ticks: Ticks, /) -> None:
        """See Cue."""
        self._pictures, self._ticks = pictures, ticks
        self.segmenters.take({i: pictures.each[i].bgr for i in pictures.present}, ticks.count)

    # --- with a body ---

    def follow(
        self,
        previous: TrackState,
        predicted: MotionState,
        dt_s: float,
        present: dict[int, float],
        keypoints: Sequence[JointTerm],
        frame_index: int,
        probe: Probe,
    ) -> ShirtEstimate | None:
        """Tracks trunk and arms from the previous state; None if the shirt is not visible there.

        predicted: the whole body, dt_s after `previous`, with its keypoints.
        """
        p, fitter, last = self.params, self.fitter, previous.trunk
        assert last is not None
        uncertain = tuple(side for side in SIDES if is_uncertain(side, last, p.limbs))
        start = upper_body_state(predicted, self.model)
        views = self.segmenters.views(start, present, uncertain)
        probe("shirt.classify")
        if not views:
            return None
        learning = (
            p.shape.learn
            and previous.taught_s < p.shape.learning_s
            and last.match > p.shape.least_match
        )
        motion = prediction_prior(
            fitter, last, start.velocity, dt_s, last.confirmed_arms, p.limbs.uncertain_arm
        )
        terms: tuple[Term, ...] = stereo_distance_terms(
            fitter, start, views, self._pictures.grey, frame_index, p.distances
        )
        if len(present) == 1:  # patches hardly say how far away an arm is
            terms += tuple(one.depths(self.model, _ARMS, p.arm_depths) for one in keypoints)
        fit = fitter.fit(
            start, views, dt_s, p.fit.iterations - self.work.fewer_iterations, learning, rendered=True,
            fine=min(self.work.fine, p.fit.fine_iterations), motion=motion, terms=terms,
        )  # fmt: skip
        probe("shirt.fit")
        unsearched = fit
        jumped: tuple[str, ...] = ()
        if self._ticks.due(self.work.hypotheses * TICK_S):
            fit, jumped = self._arms.improve(fit, views, dt_s, frame_index, terms, learning)
        probe("shirt.arms")
        if not self._is_visible(fit):
            return None
        state, taught_s = fit.state, previous.taught_s
        if learning and fit.match > p.shape.least_match:
            gained = fitter.shape_information(fit.H) * (p.shape.gain * dt_s / TICK_S)
            state = replace(state, information=state.information + gained)
            taught_s += dt_s
        velocity = velocity_between(
            self.model, upper_body_state(previous.motion, self.model), fit.state, fit.confirmed_arms, dt_s,
            [self._columns[side] for side in jumped],
        )  # fmt: skip
        redraw = fit is not unsearched or any(is_uncertain(s, unsearched, p.limbs) for s in SIDES)
        state = replace(state, velocity=velocity)
        return ShirtEstimate(fit, state, tuple(views), taught_s, jumped, redraw)

    def start_from(
        self, body: MotionState, taught_s: float, present: dict[int, float], frame_index: int
    ) -> ShirtEstimate | None:
        """Fits trunk and arms at a body from other cues, if the shirt is visible there."""
        return self._fit(upper_body_state(body, self.model), taught_s, present, frame_index)

    def _fit(
        self,
        start: MotionState,
        taught_s: float,
        present: dict[int, float],
        frame_index: int,
    ) -> ShirtEstimate | None:
        views = self.segmenters.views(start, present)
        if not views:
            return None
        fit = self.fitter.fit(start, views, NEW_BODY_PRIOR_S, self.params.fit.iterations)
        if fit.explained < _WITHOUT_ARMS * self.params.accept_match:
            return None
        fit, _ = self._arms.improve(fit, views, NEW_BODY_PRIOR_S, frame_index)
        if not self._is_acceptable(fit):
            return None
        still = replace(fit.state, velocity=np.zeros(self.model.n_pose))
        return ShirtEstimate(fit, still, tuple(views), taught_s)

    # --- from nothing ---

    def is_search_due(self, t_ns: int) -> bool:
        """Whether it is time to look for the wearer."""
        return t_ns >= self._next_search_ns

    def search(
        self,
        wearer: BodyShapeEstimate,
        present: dict[int, float],
        t_ns: int,
        pause_s: float,
        better_than: float,
        frame_index: int,
    ) -> ShirtEstimate | None:
        """Searches all pictures for the shirt. The light estimate changes only if a fit has a better match than
        `better_than`; pause_s: until the next search after a failure [s]."""
        memories = [segmenter.memory for segmenter in self.segmenters.each]
        lights = [(memory.appearance, memory.usual) for memory in memories]
        found = self._detect(wearer, present, frame_index)
        if found is not None and found.fit.match > better_than:
            self._next_search_ns = t_ns
            return found
        self._next_search_ns = t_ns + nanoseconds(pause_s)
        for memory, light in zip(memories, lights, strict=True):
            memory.appearance, memory.usual = light
        return None

    def _detect(
        self, wearer: BodyShapeEstimate, present: dict[int, float], frame_index: int
    ) -> ShirtEstimate | None:
        p, s = self.params, self.model.n_shape
        seen = self.fitter.each(
            lambda i: detection.detect_shirt(
                i, self.segmenters.each[i], self._database, p.neighbours
            ),
            present,
        )
        sightings = [one for one in seen if one is not None]
        states = detection.hypotheses(
            sightings, self._cameras, self._database, wearer.factors[:s], wearer.information[:s, :s],
            self.model.n_pose,
        )  # fmt: skip
        flat = [
            View(
                sighting.index, sighting.candidate.roi, sighting.candidate.ids,
                np.full(sighting.candidate.ids.shape, int(255 * p.segmentation.soft_unknown), np.uint8),
                present[sighting.index],
            )
            for sighting in sightings
        ]  # fmt: skip
        fit = detection.best_fit(self.fitter, states, flat)
        if fit is None:
            return None
        for sighting in sightings:
            self.segmenters.each[sighting.index].set_light(sighting.candidate.W)
        # read the pictures again, now with the pose as prior, and fit once more
        return self._fit(fit.state, wearer.taught_s, present, frame_index)

    # --- what is believed and learned ---

    def names(self, views: Sequence[View]) -> tuple[str, ...]:
        """Of the cameras of these views."""
        return tuple(self.fitter.drawings[view.index].camera.name for view in views)

    def evidence(self, views: Sequence[View]) -> tuple[Mapping[str, Bytes], Mapping[str, Roi]]:
        """The patches that were classified, and where in the frames, by camera."""
        names = self.names(views)
        ids = {name: view.ids.copy() for name, view in zip(names, views, strict=True)}
        return ids, {n: self.segmenters.roi_px(v) for n, v in zip(names, views, strict=True)}

    def _is_visible(self, fit: Fit) -> bool:
        # every second pixel was counted
        p = self.params
        return fit.match >= p.live_match and 2.0 * float(fit.matched.sum()) >= p.min_shirt_px

    def _is_acceptable(self, fit: Fit) -> bool:
        """Whether a pose found from nothing is the shirt: enough agrees, in enough colours."""
        p = self.params
        return bool(
            fit.explained >= p.accept_match
            and confirmed_colours(fit) >= p.accept_colours
            and 2.0 * fit.matched.sum() >= p.min_shirt_px
        )

    def learn(self, found: ShirtEstimate | None, present: dict[int, float], is_lost: bool) -> None:
        """Updates light and colours from the fit, and the cue's own backgrounds outside it. is_lost: no body is tracked."""
        every = 1 if found is None else self.work.learning
        if not self._ticks.due(every * TICK_S):
            return
        ticks = min(max(every, self._ticks.count), _LONGEST_TICKS)
        if found is not None:
            views, dt_s = list(found.views), ticks * TICK_S
            self.segmenters.learn_with(found.motion, found.fit, views, found.redraw, dt_s)
        self.segmenters.learn_background(present, is_lost, ticks)
