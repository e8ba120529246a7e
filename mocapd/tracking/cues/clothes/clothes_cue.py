"""Any clothes as a cue: the learned colours of body regions before a learned background place the whole body, or legs and
head below a trunk that the shirt carries."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace

import numpy as np

from mocapd.clock import seconds
from mocapd.each import Each, in_turn
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointRays
from mocapd.fit.view import View
from mocapd.geometry.camera_model import sees_from_one_place
from mocapd.tracking.base import LostReason, Probe, frozen_clock
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.clothes.clothes_solver import (
    ClothesEstimate,
    ClothesObservation,
    ClothesSolver,
)
from mocapd.tracking.cues.clothes.leg_schedule import LegSchedule, are_new_legs
from mocapd.tracking.cues.keypoints.delayed_keypoints import DelayedKeypoints
from mocapd.tracking.cues.keypoints.keypoint_consensus import agreed_keypoints
from mocapd.tracking.cues.keypoints.keypoint_detection import no_detection
from mocapd.tracking.effort import OptionalWork
from mocapd.tracking.initialisers.keypoint_initialiser import KeypointInitialiser
from mocapd.tracking.initialisers.person_search import PersonSearch
from mocapd.tracking.initialisers.room_scan import RoomScan
from mocapd.tracking.pictures import Pictures
from mocapd.tracking.ticks import Ticks
from mocapd.tracking.track_state import BodyShapeEstimate, TrackState
from mocapd.types import Bytes, FrameSet, Rig

_DEPTHS, _JOINTS = 0, 1  # what alternates; also the look is learned in frames that look for joints
_DETECTED_EVERY = 2  # ticks, without the shirt
# Cameras, from which on keypoints are shared among frame sets; before two, limbs got worse (docs/decisions/one-body.md).
_SHARED_FROM = 3


class ClothesCue:
    """Keeps each camera's background, the appearance of each region, and a search in progress.

    alone: it can place a whole body, which takes views from two places; else only legs and head below a trunk that the shirt
    carries. legs_rest: these go on as they moved, in this frame set.
    """

    name = "clothes"

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        params: ClothesParams | None = None,
        each: Each = in_turn,
        now_ns: Callable[[], int] = frozen_clock,
    ) -> None:
        """now_ns: see `registry.Resources`."""
        self.params = p = params if params is not None else ClothesParams()
        self.alone = not sees_from_one_place(rig.cameras)
        self._solver = solver = ClothesSolver(rig, stature_m, p, each)
        self.cameras, self.model = solver.cameras, solver.model
        self._delayed = DelayedKeypoints(solver.terms.joints)
        body, terms, cameras = solver.silhouettes, solver.terms, rig.cameras
        by_keypoints = KeypointInitialiser(
            body, terms.floor, terms.joints, solver.cameras, cameras, p.start, p.keypoint_start
        )
        self._search = PersonSearch(
            body, terms.floor, terms.joints, solver.cameras, cameras, by_keypoints, p, now_ns
        )
        self._scan = RoomScan(
            body, terms.joints, solver.cameras, cameras, by_keypoints, p.room_scan
        )
        self.reset()

    @property
    def fitter(self) -> Fitter:
        """Of the wearer's present look."""
        return self._solver.fitter

    @property
    def work(self) -> OptionalWork:
        """What optional work is done."""
        return self._solver.work

    @work.setter
    def work(self, work: OptionalWork) -> None:
        self._solver.work = work

    def reset(self) -> None:
        """Forget background and look."""
        self._solver.reset()
        self._search.reset()
        self._scan.reset()
        self._delayed.reset()
        self._ticks, self._legs, self.legs_rest = Ticks(1, 1, 1), LegSchedule(), False
        self._is_late = False

    def rehearse(self) -> None:
        """See `ClothesSolver`, `PersonSearch`."""
        self._solver.rehearse()
        self._search.rehearse()
        self.reset()

    def take(self, pictures: Pictures, ticks: Ticks, /) -> None:
        """See Cue."""
        self._pictures, self._ticks, self.legs_rest = pictures, ticks, False
        self._search.times.on_frame_set(pictures.t_ns)
        self.cameras.take({i: pictures.each[i].bgr for i in pictures.present}, pictures.present)

    def learn_room(self, frames: Iterable[FrameSet], pictures: Pictures) -> None:
        """See `RoomLearner`."""
        pictures_bgr: dict[int, list[Bytes]] = {}
        times_s: dict[int, list[float]] = {}
        for frame_set in frames:
            for i, late_s in pictures.load(frame_set).items():
                pictures_bgr.setdefault(i, []).append(pictures.each[i].bgr.copy())
                times_s.setdefault(i, []).append(seconds(frame_set.t_ns) + late_s)
        self.cameras.learn_room(
            pictures_bgr, {i: np.array(when_s) for i, when_s in times_s.items()}
        )

    # --- with a body ---

    def observe(
        self, predicted: MotionState, t_ns: int, legs_since_ns: int | None, shirt_carries: bool
    ) -> ClothesObservation | None:
        """Classifies the pictures about the predicted body; None without a background or an appearance model, and while the
        legs rest, see `legs_rest`.

        shirt_carries: the shirt placed trunk and arms a moment ago. Keypoints are then of the frame set before, and detected
        less often, by half of the cameras at once, or by all for new legs. Else, before three cameras and more, those of a
        detection are shared among the frame sets until the next.
        """
        self.legs_rest = False
        self.cameras.set_newcomers_aside()
        if not self._knows_look:
            return None
        if (
            shirt_carries
            and not are_new_legs(t_ns, legs_since_ns, self.params)
            and self._legs.rests(self._ticks.last, self._solver.work.legs, self._is_late)
        ):
            self.legs_rest = True
            return None
        keypoints, every = self._delayed, _DETECTED_EVERY * self._solver.work.network
        is_shared = not shirt_carries and len(self.cameras.present) >= _SHARED_FROM
        if shirt_carries:
            detect = keypoints.take(self.fitter, predicted, t_ns, self.cameras)
        elif self._ticks.alternates(every, _JOINTS):
            detect = keypoints.detector(self.fitter, predicted, t_ns, self.cameras)
        elif is_shared:
            detect = keypoints.moved(self.fitter, predicted, t_ns, self.cameras)
        else:
            detect = no_detection
        rays: list[JointRays | None]
        views, rays = self.cameras.prepare(
            predicted, self._solver.searches_everywhere(self._ticks), detect
        )
        share = min(self._ticks.usual / every, 1.0) if is_shared else 1.0
        found = [one for one in rays if one is not None]
        agreed = agreed_keypoints(found, self.fitter.joints(predicted)[0])
        terms = self._solver.terms.joints.term(self.model, agreed, share)
        return ClothesObservation(predicted, views, terms)

    def detect_keypoints(
        self, body: MotionState, t_ns: int, legs_since_ns: int | None, is_late: bool
    ) -> None:
        """Detects keypoints about a body that the shirt carries in this frame set, at t_ns, for the next fit of its legs.
        is_late: the next frame set waits, so the legs rest in it, unless they are new or rested in this one."""
        self._is_late = is_late
        if not self._knows_look:
            return
        cameras = self._detecting(are_new_legs(t_ns, legs_since_ns, self.params))
        if cameras:
            self._delayed.detect(self.fitter, body, t_ns, self.cameras, cameras)

    def _detecting(self, is_new: bool) -> Sequence[int]:
        """The cameras whose keypoints are detected now below the shirt; is_new: the legs were found a moment ago."""
        present, work = self.cameras.present, self._solver.work
        if not self.alone or len(present) == 1:  # nothing else says how far away the arms are
            return self._legs.keypoints.take(present, self._ticks.last, TICK_S * work.network)
        if not is_new and self._legs.rests(self._ticks.last + 1, work.legs, self._is_late):
            return ()
        most = len(present) if is_new else (len(present) + 1) // 2
        every_s = self.params.guided_joints_s * work.network
        return self._legs.keypoints.take(present, self._ticks.last, every_s, most)

    @property
    def _knows_look(self) -> bool:
        """True if each present camera that is no newcomer has a background and an appearance model."""
        return not self.cameras.are_new and self.cameras.has_appearance

    def fit_whole_body(
        self,
        state: TrackState,
        observed: ClothesObservation,
        dt_s: float,
        probe: Probe,
    ) -> ClothesEstimate | None:
        """Fits the whole body, dt_s after `state`; None if too little of it is visible."""
        found = self._solver.fit_whole_body(
            state, observed, dt_s, self._pictures, self._ticks, self._measures_depths, probe
        )
        if found is not None:
            t_ns = self._pictures.t_ns
            self._search.on_body(found.motion.root_m, t_ns)
            self._delayed.on_body(self.fitter, found.motion, t_ns)
        return found

    def fit_lower_body(
        self,
        state: TrackState,
        start: MotionState,
        observed: ClothesObservation | None,
        dt_s: float,
        probe: Probe,
    ) -> ClothesEstimate | None:
        """Fits legs and head of a body whose trunk and arms, in `start`, come from the shirt; dt_s after `state`."""
        self._search.give_up()
        if self.legs_rest and state.whole is not None:
            return ClothesEstimate(state.whole, start, (), ())
        ticks = replace(self._ticks, frame_index=self._legs.turn(self._ticks.frame_index))
        found = self._solver.fit_lower_body(
            state, start, observed, dt_s, self._pictures, ticks, probe
        )
        if found is not None:
            self._search.on_body(found.motion.root_m, self._pictures.t_ns)
            joints_m, _ = self.fitter.joints(found.motion)
            crossing = not self.fitter.has_small_baseline(found.motion, found.views)
            self._legs.on_fit(joints_m, self._ticks.last, self._pictures.t_ns, crossing)
        return found

    @property
    def _measures_depths(self) -> bool:
        """Whether this frame does, where cameras look from one side; others look for joints, and learn."""
        return self._ticks.alternates(2 * self._solver.work.depths, _DEPTHS)

    # --- from nothing ---

    def search(self, wearer: BodyShapeEstimate, t_ns: int) -> ClothesEstimate | None:
        """Searches for a person in the foreground; between such searches for one without it."""
        searches = self._search.times.is_due(t_ns)
        found = (self._search if searches else self._scan).look(
            wearer.factors, wearer.information, t_ns
        )
        if found is None or not self._search.is_in_reach(found[0], t_ns):
            return None
        self._scan.rest()
        fit, names = found
        if not searches:  # the room was learned with this person
            self.cameras.forget_background(fit.state)
        self.cameras.mark_body(fit.state)
        self.cameras.remove_ghosts()
        self.cameras.distrust_background()
        self._solver.appearance.learn_first(fit.state, self.cameras)
        return ClothesEstimate(fit, fit.state, (), names)

    def start_from(self, body: MotionState) -> ClothesEstimate | None:
        """Starts from a body of another tracker, if the pictures show its outline."""
        return self._solver.start_from(body, self._pictures, self._ticks)

    def lost_reason(self, t_ns: int) -> LostReason | None:
        """Why no person is tracked, if known."""
        return self._search.lost_reason(t_ns)

    # --- learning ---

    def learn(self, found: ClothesEstimate | None, is_lost: bool, shirt_carries: bool) -> None:
        """Updates the appearance from a body that fits well, and the background beside it, or everywhere while the track
        is lost."""
        p, cameras, interval = self.params, self.cameras, self._solver.work.learning
        if self._ticks.count == 0 or self.legs_rest:
            return  # more frames do not teach faster, and a body that was not drawn anew marks no background
        if is_lost and not self._ticks.due(p.absorb_s):
            cameras.mark_unknown()  # what stays for long is furniture that was moved
        elif is_lost:
            cameras.mark_body(None)
        agrees = found is not None and found.fit.explained >= p.learn_explained
        if found is not None and agrees and cameras.newcomers:
            cameras.admit_newcomers(found.motion, self._solver.appearance.merge)
        views: Sequence[View] = ()
        if found is not None and shirt_carries:
            shown = {view.index: view for view in found.views}
            every_s = p.guided_look_s * interval
            views = [shown[i] for i in self._legs.look.take(shown, self._ticks.last, every_s)]
        elif found is not None and self._ticks.alternates(2 * interval, _JOINTS):
            # depths and arms that are searched for make their frames long enough
            views = found.views
        cameras.learn(
            found.motion if found is not None and agrees else None, views, self._ticks.count
        )
