"""Searches the foreground for the person to track; of several people, the nearest."""

from collections.abc import Callable, Generator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.clock import nanoseconds, seconds
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import turned_about_vertical
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.floor_term import FloorTerm
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.fit.view import View
from mocapd.geometry.camera_model import centre
from mocapd.tracking.base import LostReason
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.tracking.cues.keypoints.keypoint_consensus import agreed_keypoints
from mocapd.tracking.cues.keypoints.keypoint_detection import KeypointDetectors
from mocapd.tracking.cues.keypoints.limbs_at_keypoints import (
    limbs_off_crossings,
    with_limbs_at_keypoints,
)
from mocapd.tracking.initialisers.attempt_schedule import AttemptSchedule
from mocapd.tracking.initialisers.hull_candidates import (
    HullCandidate,
    hull_candidates,
    rehearse_hull,
)
from mocapd.tracking.initialisers.keypoint_initialiser import KeypointCandidate, KeypointInitialiser
from mocapd.tracking.initialisers.motion_monitor import MotionMonitor
from mocapd.tracking.initialisers.standing_initialiser import (
    PersonCandidate,
    blobs_of,
    fit_first_pose,
    fit_to_blobs,
    is_upright,
    person_candidates,
    views_of,
)
from mocapd.types import Bytes, Camera, Floats
from mocapd.vision.foreground_kernels import BACKGROUND

Found = tuple[Fit, tuple[str, ...]]  # a body and the names of the cameras that show it


@dataclass(frozen=True, slots=True, eq=False)
class _SearchCandidate:
    """A candidate person in the foreground, with its views. shadows: the blobs include possible shadows; by_keypoints:
    set if the keypoint initialiser found it."""

    person: PersonCandidate
    shadows: bool
    views: tuple[View, ...]
    by_keypoints: KeypointCandidate | None = None


_Likely = tuple[Fit, _SearchCandidate]
_TURNS = 2  # of a first pose by keypoints: about, and the rest of the way


class PersonSearch:
    """Searches for a person; on a slow machine one search runs over several frame sets, so that capture and output
    continue. Keeps the schedule and the candidates of the last search."""

    def __init__(
        self,
        silhouettes: Fitter,
        floor: FloorTerm,
        joints: KeypointDetectors,
        views: CameraViews,
        cameras: Sequence[Camera],
        by_keypoints: KeypointInitialiser,
        params: ClothesParams,
        now_ns: Callable[[], int],
    ) -> None:
        """silhouettes: a fitter whose body has one region; cameras: those of the views; by_keypoints: where silhouettes tell
        nobody; now_ns: see `Resources`."""
        self._silhouettes, self._floor, self._views = silhouettes, floor, views
        self._cameras, self._params, self._clock_ns = cameras, params.start, now_ns
        self._joints, self._least_joints = joints, params.keypoint_start.least_joints
        self._hull_params = params.hull_start
        self._scales = [view.image_scale for view in views.each]
        self._motion = MotionMonitor(params.motion_monitor)
        self._by_keypoints = by_keypoints
        self.reset()

    def reset(self) -> None:
        """Forgets all candidates and searches at once."""
        self.times = AttemptSchedule(self._params)
        self._likely_m: list[Floats] = []
        self._by_keypoints.reset()
        self._motion.reset()
        self._confirms = False  # the next search, what the last one found
        self._last: tuple[Floats, int] | None = None
        # of the newest pictures that were searched
        self._clear: dict[int, Bytes] = {}
        self._hull: list[HullCandidate] | None = None
        self.give_up()

    def rehearse(self) -> None:
        """Loads the kernel that the first search before three cameras or more would wait for."""
        rehearse_hull(self._cameras, self._hull_params)

    def on_body(self, root_m: Floats, t_ns: int) -> None:
        """Remembers where (3,) and when the tracked person was."""
        self._last = root_m, t_ns

    def give_up(self) -> None:
        """Cancels the search in progress."""
        self._under_way: Generator[None, None, _Likely | None] | None = None
        self._earlier: _Likely | None = None  # found in older pictures, to be refitted to the next

    def look(self, factors: Floats, information: Floats, t_ns: int) -> Found | None:
        """A person of this shape in the newest pictures, with the cameras that show it; None if none is confirmed yet or
        no search is due."""
        if self._views.are_new:
            self.give_up()
            return None
        if not self.times.is_due(t_ns):
            return None
        if self._earlier is not None:
            earlier = self._earlier
            self.give_up()
            self.times.on_attempt(t_ns, pauses=True)
            return self._found(self._as_now(*earlier))
        begins = self._under_way is None
        if self._under_way is None:
            self._update_foreground()
            self._motion.update(
                t_ns, {i: self._views.each[i].foreground for i in self._views.present}
            )
            self._under_way = self._search(factors, information, t_ns)
        until_ns = self._clock_ns() + nanoseconds(self._params.longest_s)
        try:
            next(self._under_way)
            while self._clock_ns() < until_ns:
                next(self._under_way)
        except StopIteration as end:
            self.give_up()
            likeliest: _Likely | None = end.value
            if likeliest is None or (begins and self._clock_ns() < until_ns):
                # the next frame set may confirm somebody; who is found at another place each time waits
                is_half_sure = bool(self._likely_m) or self._by_keypoints.is_half_sure
                self._confirms = likeliest is None and is_half_sure and not self._confirms
                self.times.on_attempt(t_ns, pauses=not self._confirms)
                return self._found(likeliest)
            self._earlier = likeliest
            return None
        self.times.on_attempt(t_ns, pauses=False)
        return None

    def _found(self, likeliest: _Likely | None) -> Found | None:
        if likeliest is None:
            return None
        self._motion.reset()
        return likeliest[0], self._names(likeliest[1])

    def lost_reason(self, t_ns: int) -> LostReason | None:
        """Why no person is found, if known."""
        return self._motion.reason(t_ns)

    def _search(
        self, factors: Floats, information: Floats, t_ns: int
    ) -> Generator[None, None, _Likely | None]:
        """A whole search of the newest foreground. Yields after each fit, so that a later frame set may continue it."""
        p = self._params
        likely: list[_Likely] = []
        for shadows in (False, True):
            if any(fit.explained >= p.accept_explained for fit, _ in likely):
                break  # nobody's dark clothes were taken for shadows
            for candidate in self._standing_candidates(shadows):
                fit = yield from fit_first_pose(
                    self._silhouettes,
                    candidate.person,
                    candidate.views,
                    factors,
                    information,
                    (self._floor,),
                    p,
                )
                if not self._is_likely(fit) or not self.is_in_reach(fit, t_ns):
                    continue
                person = self._as_person(fit, candidate)
                if person is not None:
                    likely.append((person, candidate))
        last, self._likely_m = self._likely_m, [fit.state.root_m for fit, _ in likely]
        if not likely:
            found = yield from self._by_keypoints.look(factors, information, self._hull)
            if found is None or not self.is_in_reach(found.fit, t_ns):
                return None
            return _from_keypoints(found, self._views.present)
        self._by_keypoints.reset()
        fit, candidate = max(likely, key=lambda one: self._worth(one[0], t_ns))
        again = any(np.linalg.norm(fit.state.root_m - one) < p.same_place_m for one in last)
        if fit.explained < p.accept_explained and not again:
            return None
        return fit, candidate

    def _as_now(self, fit: Fit, then: _SearchCandidate) -> _Likely | None:
        """The person of older pictures refitted to the newest ones; None if no candidate is near."""
        p = self._params
        self._update_foreground()
        if then.by_keypoints is not None:
            found = self._by_keypoints.now(then.by_keypoints, p.walked_m, self._hull)
            return None if found is None else _from_keypoints(found, self._views.present)
        away_m, now = min(
            (
                (float(np.linalg.norm(one.person.place_m - then.person.place_m)), one)
                for one in self._standing_candidates(then.shadows)
            ),
            key=lambda one: one[0],
            default=(np.inf, then),
        )
        if away_m > p.walked_m:
            return None
        step_m = now.person.place_m - then.person.place_m
        start = replace(fit.state, root_m=fit.state.root_m + step_m)
        fit = fit_to_blobs(self._silhouettes, now.views, start, p.iterations, (self._floor,), p)
        return (fit, now) if self._is_likely(fit) else None

    def _update_foreground(self) -> None:
        """Segments the foreground of whole pictures, without a body, and carves the hull if enough cameras are clear."""
        views = self._views
        views.mark_body(None)
        views.update_foreground()
        views.remove_ghosts()
        self._clear = {i: views.each[i].foreground for i in self._clear_cameras()}
        self._hull = hull_candidates(self._clear, self._cameras, self._scales, self._hull_params)

    def _standing_candidates(self, shadows: bool) -> list[_SearchCandidate]:
        """The likeliest upright people in the foreground. shadows: include possible shadows, which the hull always does."""
        p = self._params
        if self._hull is not None:
            people = [] if shadows else [one.person for one in self._hull]
        else:
            blobs = {i: blobs_of(before, shadows, p) for i, before in self._clear.items()}
            stature_m = self._silhouettes.model.stature_m
            people = person_candidates(blobs, self._cameras, self._scales, stature_m, p)[: p.people]
        present = self._views.present
        return [_SearchCandidate(person, shadows, views_of(person, present)) for person in people]

    def _clear_cameras(self) -> list[int]:
        """Cameras without those whose picture hardly shows its background (changed light, or a person close to the lens):
        such a silhouette carries no information. All cameras if fewer than two would remain."""
        views, most = self._views, self._params.most_share
        clear = [
            i for i in views.present if np.mean(views.each[i].foreground != BACKGROUND) <= most
        ]
        return clear if len(clear) > 1 else list(views.present)

    def _is_likely(self, fit: Fit) -> bool:
        return fit.explained >= self._params.likely_explained and is_upright(self._silhouettes, fit)

    def _worth(self, fit: Fit, t_ns: int) -> float:
        """Agreement, less what a person farther from the cameras must have more, as a passer-by is seldom in front, and one
        farther from where somebody was tracked, the less the longer that is ago."""
        away_m, ago_s = self._from_last(fit, t_ns)
        elsewhere = self._params.elsewhere_per_m * away_m / (1.0 + ago_s)
        return fit.explained - self._params.farther_per_m * self._away_m(fit) - elsewhere

    def is_in_reach(self, fit: Fit, t_ns: int) -> bool:
        """False for somebody where the person who was lost a moment ago cannot have walked."""
        away_m, ago_s = self._from_last(fit, t_ns)
        return away_m <= self._params.same_place_m + self._params.walks_m_s * ago_s

    def _from_last(self, fit: Fit, t_ns: int) -> tuple[float, float]:
        """Distance from where a person was tracked last [m], and how long ago [s]; 0 and inf if nobody was, or later."""
        root_m, then_ns = self._last or (fit.state.root_m, t_ns + 1)
        if then_ns > t_ns:
            return 0.0, np.inf
        return float(np.linalg.norm(fit.state.root_m - root_m)), seconds(t_ns - then_ns)

    def _as_person(self, fit: Fit, candidate: _SearchCandidate) -> Fit | None:
        """The fit, turned if keypoints say so: silhouettes of cameras all around hardly tell front from back; and with limbs
        moved that they show elsewhere. None if the
        heatmaps of head and neck are as blurred as for furniture in all pictures that show enough keypoints."""
        p, fitter = self._params, self._silhouettes
        detect = self._joints.detector(fitter, fit.state, self._views)
        terms = self._joints.term(fitter.model, fitter.each(detect, candidate.person.blobs))
        spreads_m = [one for term in terms for one in term.head_spreads_m(self._least_joints)]
        finite_m = [spread_m for spread_m in spreads_m if spread_m < np.inf]
        if not finite_m:
            return fit
        if min(finite_m) > p.head_spread_m:
            return None
        for _ in range(_TURNS):
            turn_rad = terms[0].turn_rad(fitter.joints(fit.state)[0])
            if abs(turn_rad) < p.turned_rad:
                break
            turned = turned_about_vertical(fit.state, turn_rad)
            other = fit_to_blobs(
                fitter, candidate.views, turned, p.iterations, (self._floor, *terms), p
            )
            less = p.turned_less if abs(turn_rad) >= p.turned_about_rad else 0.0
            if other.explained <= fit.explained - less:
                break
            fit = other
        return self._with_lost_limbs(fit, candidate, terms[0])

    def _with_lost_limbs(self, fit: Fit, candidate: _SearchCandidate, keypoints: JointTerm) -> Fit:
        """The fit, with limbs laid through the keypoints on which three cameras or more agree, where it explains more: the
        look of the clothes is learned from the first pose."""
        p, fitter = self._params, self._silhouettes
        joints_m = fitter.joints(fit.state)[0]
        (agreed,) = self._joints.term(fitter.model, agreed_keypoints(keypoints.rays, joints_m))
        lost = limbs_off_crossings(agreed, joints_m)
        if not lost:
            return fit
        start = with_limbs_at_keypoints(fitter, fit.state, agreed, lost)
        other = fit_to_blobs(fitter, candidate.views, start, p.iterations, (self._floor, agreed), p)
        return other if other.explained > fit.explained else fit

    def _names(self, candidate: _SearchCandidate) -> tuple[str, ...]:
        return tuple(self._views.each[i].name for i in candidate.person.blobs)

    def _away_m(self, fit: Fit) -> float:
        """From the cameras, on average."""
        eyes = [centre(camera) for camera in self._cameras]
        return float(np.linalg.norm(np.array(eyes) - fit.state.root_m, axis=1).mean())


def _from_keypoints(found: KeypointCandidate, present: Mapping[int, float]) -> _Likely:
    """present: see `CameraViews`."""
    views = views_of(found.person, present)
    return found.fit, _SearchCandidate(found.person, found.shadows, views, found)
