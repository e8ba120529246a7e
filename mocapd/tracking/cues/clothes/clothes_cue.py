"""Any clothes as a cue: the learned colours of body regions before a learned background place the whole body, or legs and
head below a trunk that the shirt carries."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from mocapd.clock import nanoseconds, seconds
from mocapd.each import Each, in_turn
from mocapd.fit.fit_params import TICK_S
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.joint_term import JointRays
from mocapd.fit.view import View
from mocapd.tracking.base import Probe, no_time_passes
from mocapd.tracking.cues.clothes.clothes_fits import ClothesFits, ClothesFound, Observed
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.keypoints.joint_views import unwatched
from mocapd.tracking.effort import OptionalWork
from mocapd.tracking.initialisers.person_search import PersonSearch
from mocapd.tracking.lost_reason import LostReason
from mocapd.tracking.pictures import Pictures
from mocapd.tracking.ticks import Ticks
from mocapd.tracking.track_state import Proportions, TrackState
from mocapd.types import Bytes, FrameSet, Rig
from mocapd.vision.face.lbp_cascade_kernels import CascadeArrays

_DEPTHS, _JOINTS = 0, 1  # what alternates; also the look is learned in frames that look for joints


class ClothesCue:
    """Remembers each camera's background and the colours of each region, and who may be coming in."""

    name = "clothes"

    def __init__(
        self,
        rig: Rig,
        stature_m: float,
        params: ClothesParams | None = None,
        cascade: CascadeArrays | None = None,
        each: Each = in_turn,
        now_ns: Callable[[], int] = no_time_passes,
    ) -> None:
        """cascade, each: see `ClothesFits`; now_ns: see `registry.Resources`."""
        self.params = p = params if params is not None else ClothesParams()
        self._fits = fits = ClothesFits(rig, stature_m, p, cascade, each)
        self.cameras, self.model = fits.cameras, fits.model
        self._find = PersonSearch(
            fits.silhouettes, fits.terms.floor, fits.terms.joints, fits.cameras, rig.cameras, p.start,
            p.keypoint_start, p.motion_watch, now_ns,
        )  # fmt: skip
        self.reset()

    @property
    def fitter(self) -> Fitter:
        """Of the wearer's present look."""
        return self._fits.fitter

    @property
    def work(self) -> OptionalWork:
        """What optional work is done."""
        return self._fits.work

    @work.setter
    def work(self, work: OptionalWork) -> None:
        self._fits.work = work

    def reset(self) -> None:
        """Forget background and look."""
        self._fits.reset()
        self._find.reset()
        self._ticks = Ticks(1, 1, 1)

    def rehearse(self) -> None:
        """See `ClothesFits`."""
        self._fits.rehearse()
        self.reset()

    def take(self, pictures: Pictures, ticks: Ticks, /) -> None:
        """See Cue."""
        self._ticks = ticks
        self._find.times.came(pictures.t_ns)
        self.cameras.take({i: pictures.each[i].bgr for i in pictures.present}, pictures.present)

    def learn_room(self, frames: Iterable[FrameSet], pictures: Pictures) -> None:
        """See `RoomLearner`."""
        shown: dict[int, list[Bytes]] = {}
        times_s: dict[int, list[float]] = {}
        for one in frames:
            for i, late_s in pictures.look(one).items():
                shown.setdefault(i, []).append(pictures.each[i].bgr.copy())
                times_s.setdefault(i, []).append(seconds(one.t_ns) + late_s)
        self.cameras.know_room(shown, {i: np.array(when_s) for i, when_s in times_s.items()})

    # --- with a body ---

    def observe(
        self, predicted: MotionState, t_ns: int, legs_since_ns: int | None, carried: bool
    ) -> Observed | None:
        """The pictures by the regions of the predicted body; None where its look or the background is not known yet.

        carried: whether the shirt carried trunk and arms a moment ago: fewer looks at the joints will do then, and none
        while the legs are new, which were just found elsewhere.
        """
        p = self.params
        if self.cameras.are_new or not self.cameras.know_appearance:
            return None
        if carried and self._rests_legs:
            return None
        if carried:
            is_new = legs_since_ns is None or t_ns - legs_since_ns <= nanoseconds(
                p.guided_joint_after_s
            )
            looks = (
                self._ticks.due(p.guided_joints_s * self._fits.work.network, TICK_S) and not is_new
            )
        else:
            looks = self._ticks.alternates(2 * self._fits.work.network, _JOINTS)
        joints, fitter = self._fits.terms.joints, self.fitter
        watch = joints.watch(fitter, predicted, self.cameras) if looks else unwatched
        rays: list[JointRays | None]
        views, rays = self.cameras.prepared(predicted, self._fits.looks_round(self._ticks), watch)
        return Observed(predicted, views, joints.term(self.model, rays))

    def whole(
        self, known: TrackState, seen: Observed, dt_s: float, frames: FrameSet, probe: Probe
    ) -> ClothesFound | None:
        """The whole body, dt_s after it was known; None where too little of it is seen."""
        return self._fits.whole(
            known, seen, dt_s, frames, self._ticks, self._measures_depths, probe
        )

    def below(
        self,
        known: TrackState,
        start: MotionState,
        seen: Observed | None,
        dt_s: float,
        frames: FrameSet,
        probe: Probe,
    ) -> ClothesFound | None:
        """Legs and head of a body whose trunk and arms, in `start`, the shirt carries; dt_s after it was known."""
        self._find.give_up()
        if seen is None and self._rests_legs and known.whole is not None:
            return ClothesFound(known.whole, start, (), ())
        return self._fits.below(known, start, seen, dt_s, frames, self._ticks, probe)

    @property
    def _measures_depths(self) -> bool:
        """Whether this frame does, where cameras look from one side; others look for joints, and learn."""
        return self._ticks.alternates(2 * self._fits.work.depths, _DEPTHS)

    @property
    def _rests_legs(self) -> bool:
        """Whether legs and head below a trunk that the shirt carries go on as they moved."""
        legs = self._fits.work.legs
        return legs > 1 and not self._ticks.alternates(legs, 0)

    # --- from nothing ---

    def search(self, wearer: Proportions, t_ns: int) -> ClothesFound | None:
        """Look for somebody who stands before the background."""
        found = self._find.look(wearer.factors, wearer.information, t_ns)
        if found is None:
            return None
        fit, names = found
        self.cameras.mark_body(fit.state)
        self.cameras.remove_ghosts()
        self.cameras.doubt_background()
        self._fits.wardrobe.learn_first(fit.state, self.cameras)
        return ClothesFound(fit, fit.state, (), names)

    def begin(self, there: MotionState, frames: FrameSet) -> ClothesFound | None:
        """Begin from a body as it was known elsewhere, if the pictures have its outline."""
        return self._fits.begin(there, frames, self._ticks)

    def lost_reason(self, t_ns: int) -> LostReason | None:
        """Why nobody is found, where that can be told."""
        return self._find.lost_reason(t_ns)

    # --- learning ---

    def learn(self, found: ClothesFound | None, nobody: bool, carried: bool) -> None:
        """The look of a body that agrees well, and the background beside it, or everywhere where nobody is known."""
        p, cameras, looks = self.params, self.cameras, self._fits.work.looks
        if self._ticks.count == 0:
            return  # more frames do not teach faster
        if nobody and not self._ticks.due(p.absorb_s):
            cameras.mark_unknown()  # what stays for long is furniture that was moved
        elif nobody:
            cameras.mark_body(None)
        agrees = found is not None and found.fit.explained >= p.learn_explained
        views: Sequence[View] = ()
        if found is not None and carried:
            # with two cameras: the look is learned in one of them, in two of four frames
            views = [
                view
                for k, view in enumerate(found.views)
                if self._ticks.due(p.guided_look_s * looks, k * TICK_S)
            ]
        elif found is not None and self._ticks.alternates(2 * looks, _JOINTS):
            # depths and arms that are searched for make their frames long enough
            views = found.views
        cameras.learn(
            found.motion if found is not None and agrees else None, views, self._ticks.count
        )
