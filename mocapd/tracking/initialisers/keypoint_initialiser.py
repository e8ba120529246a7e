"""The first pose of a person who does not stand facing the cameras, from detected keypoints.

The network runs on each foreground blob that all cameras show in one place, or on each part of the visual hull. A pose from
its triangulated keypoints is fitted to keypoints and silhouettes. It counts as a person only if the silhouette agrees, most
keypoints agree in most cameras and the body touches the floor, in two successive searches at one place: furniture, shadows
and screens fail these checks. Where no background is known, because the person always stood there, the silhouette is the
network's.
"""

from collections.abc import Generator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mocapd.body.skeleton import INDEX, N_JOINTS
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.floor_term import FloorTerm
from mocapd.fit.terms.joint_term import JointRays, JointTerm
from mocapd.geometry import rotations
from mocapd.geometry.camera_model import project, rays
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import KeypointStartParams, StartParams
from mocapd.tracking.cues.keypoints.keypoint_detection import CameraKeypoints, KeypointDetectors
from mocapd.tracking.initialisers.hull_candidates import HullCandidate
from mocapd.tracking.initialisers.keypoint_pose import pose_through, triangulated_joints
from mocapd.tracking.initialisers.standing_initialiser import (
    Blob,
    PersonCandidate,
    blobs_of,
    fit_to_blobs,
    views_of,
)
from mocapd.types import Camera, Floats
from mocapd.vision.heatmaps.person_crop import middle_of

_HIPS, _NECK = INDEX["hips"], INDEX["neck"]
_HIGHEST_MIDDLE_M = 1.6  # of a body that touches the floor


@dataclass(frozen=True, slots=True, eq=False)
class KeypointCandidate:
    """A candidate fitted to keypoints and silhouettes. shadows: the blobs include possible shadows.

    spread_m: median heatmap spread of the keypoints in the best camera but one, or in the only one; off_sds2: median squared
    distance of the body's joints from the keypoints in the worst camera [standard deviations^2]; apart_m: mean distance of
    the body's joints from the triangulated ones; lowest_m: height of the lowest joint.
    """

    fit: Fit
    person: PersonCandidate
    shadows: bool
    spread_m: float
    off_sds2: float
    apart_m: float
    lowest_m: float


@dataclass(frozen=True, slots=True, eq=False)
class KeypointPose:
    """A body through keypoints alone, with these and the places (J,3) where their rays meet, see `triangulated_joints`."""

    state: MotionState
    joints: JointTerm
    places_m: Floats


class KeypointInitialiser:
    """See the module's docstring. Keeps the places of the last search."""

    def __init__(
        self,
        silhouettes: Fitter,
        floor: FloorTerm,
        joints: KeypointDetectors,
        views: CameraViews,
        cameras: Sequence[Camera],
        start: StartParams,
        params: KeypointStartParams,
    ) -> None:
        """silhouettes: a fitter whose body has one region; cameras: those of the views."""
        self._silhouettes, self._floor, self._joints = silhouettes, floor, joints
        self._views, self._cameras = views, cameras
        self._params = params
        self._start = replace(start, least_height_px=params.least_height_px)
        self.reset()

    def reset(self) -> None:
        """Forgets these places."""
        self._last_m: list[Floats] = []

    @property
    def is_half_sure(self) -> bool:
        """True if the last search found somebody whom a second one may confirm."""
        return bool(self._last_m)

    def look(
        self, factors: Floats, information: Floats, hull: Sequence[HullCandidate] | None
    ) -> Generator[None, None, KeypointCandidate | None]:
        """A person of this shape found in two successive searches; yields after each attempt. hull: see `hull_candidates`;
        None: the blobs of all cameras are matched."""
        found: list[KeypointCandidate] = []
        for shadows in (False, True):
            for middle_m, person in self._candidates(shadows, hull):
                one = self.attempt(middle_m, person, shadows, factors, information)
                if one is not None and self.is_person(one):
                    found.append(one)
                yield
        last, self._last_m = self._last_m, [one.fit.state.root_m for one in found]
        again = [
            one
            for one in found
            if any(
                np.linalg.norm(one.fit.state.root_m - at_m) < self._params.same_place_m
                for at_m in last
            )
        ]
        return max(again, key=self._worth, default=None)

    def now(
        self, then: KeypointCandidate, walked_m: float, hull: Sequence[HullCandidate] | None
    ) -> KeypointCandidate | None:
        """A person of older pictures refitted to the newest ones; None if none is within walked_m [m]. hull: as for look."""
        near = [
            (away_m, middle_m, person)
            for middle_m, person in self._candidates(then.shadows, hull)
            if (away_m := float(np.linalg.norm(person.place_m - then.person.place_m))) <= walked_m
        ]
        if not near:
            return None
        _, middle_m, person = min(near, key=lambda one: one[0])
        state = then.fit.state
        found = self.attempt(middle_m, person, then.shadows, state.factors, state.information)
        return found if found is not None and self.is_person(found) else None

    def _worth(self, one: KeypointCandidate) -> float:
        return one.fit.explained - (self._params.shadows_more if one.shadows else 0.0)

    def attempt(
        self,
        middle_m: Floats,
        person: PersonCandidate,
        shadows: bool,
        factors: Floats,
        information: Floats,
    ) -> KeypointCandidate | None:
        """A pose about middle_m (3,) for these blobs, of the cameras that are present now; None if the network is unsure of
        the keypoints in half of them, or sees no trunk."""
        fitter, posed = self._silhouettes, None
        state = upright_about(fitter, middle_m, factors, information)
        sure: dict[int, CameraKeypoints] = {}
        for _ in range(self._params.looks):
            found: dict[int, CameraKeypoints] = {}
            fitter.each(self._joints.detector(fitter, state, self._views, found), person.blobs)
            sure = self.sure(found, len(person.blobs))
            posed = self.pose([one.rays for one in sure.values()], state)
            if posed is None:
                return None
            state = posed.state
        if posed is None:
            return None
        blobs = {i: self._completed(person.blobs[i], i, one) for i, one in sure.items()}
        return self.candidate(posed, replace(person, blobs=blobs), shadows)

    def spreads_m(self, found: Mapping[int, CameraKeypoints]) -> Sequence[float]:
        """How far each camera's keypoints spread, see `JointTerm.median_spreads_m`."""
        term = JointTerm(self._silhouettes.model, [one.rays for one in found.values()])
        return term.median_spreads_m(self._params.least_joints)

    def sure(
        self, found: Mapping[int, CameraKeypoints], cameras: int
    ) -> dict[int, CameraKeypoints]:
        """The detections without blurred ones; none unless more than half of so many cameras remain."""
        sure = {
            i: one
            for (i, one), spread_m in zip(found.items(), self.spreads_m(found), strict=True)
            if spread_m <= self._params.hopeless_m
        }
        return sure if len(sure) > cameras // 2 else {}

    def pose(self, rays: Sequence[JointRays], about: MotionState) -> KeypointPose | None:
        """A pose through all these keypoints, which were detected about a body; None without any or if they show no
        trunk."""
        p, fitter = self._params, self._silhouettes
        terms = self._joints.term(fitter.model, rays)
        if not terms:
            return None
        joints = terms[0]
        places_m = triangulated_joints(joints.rays, about.root_m, p.middle_sd_m)
        posed = pose_through(fitter, places_m, about.factors, about.information)
        if posed is None:
            return None
        held = (self._floor, joints.trusting)
        state = fitter.fit(posed, (), self._start.loose_s, p.iterations, terms=held).state
        return KeypointPose(state, joints, places_m)

    def candidate(
        self, posed: KeypointPose, person: PersonCandidate, shadows: bool
    ) -> KeypointCandidate:
        """The pose fitted to keypoints and silhouettes."""
        fitter, joints = self._silhouettes, posed.joints
        fit = fit_to_blobs(
            fitter, views_of(person, self._views.present), posed.state, self._start.iterations, (self._floor, joints),
            self._start,
        )  # fmt: skip
        joints_m = fitter.joints(fit.state)[0]
        has_place = np.isfinite(posed.places_m[:, 0])
        apart_m = float(np.linalg.norm(posed.places_m - joints_m, axis=1)[has_place].mean())
        return KeypointCandidate(
            fit,
            person,
            shadows,
            sorted(joints.median_spreads_m(self._params.least_joints))[:2][-1],
            joints.worst_off_sds2(joints_m),
            apart_m,
            float(joints_m[:, 1].min()),
        )

    def _completed(self, blob: Blob, camera: int, found: CameraKeypoints) -> Blob:
        """The blob, with what the network takes for the person where no background is known."""
        x0, y0, x1, y1 = blob.roi
        is_person = self._views.each[camera].person_in(found.odds, found.crop)[y0:y1, x0:x1]
        mask = np.where(blob.has_background, blob.mask, is_person).astype(np.uint8)
        return replace(blob, mask=mask, has_background=np.ones_like(blob.has_background))

    def is_person(self, one: KeypointCandidate, spread_m: float | None = None) -> bool:
        """True if keypoints and silhouettes agree on a person on the floor. spread_m: its largest, if not the usual."""
        p = self._params
        low_m, high_m = p.lowest_m
        return (
            one.fit.explained >= p.explained + (p.shadows_more if one.shadows else 0.0)
            and one.spread_m <= (p.spread_m if spread_m is None else spread_m)
            and one.off_sds2 <= p.off_sds2
            and one.apart_m <= p.apart_m
            and low_m <= one.lowest_m <= high_m
        )

    def _candidates(
        self, shadows: bool, hull: Sequence[HullCandidate] | None
    ) -> list[tuple[Floats, PersonCandidate]]:
        """Candidate body centres (3,) with their blobs."""
        if hull is not None:
            return [] if shadows else [(one.middle_m, one.person) for one in hull]
        views = self._views
        blobs = {i: blobs_of(views.each[i].foreground, shadows, self._start) for i in views.present}
        if not blobs or any(not one for one in blobs.values()):
            return []
        scales = [one.image_scale for one in views.each]
        first = next(iter(blobs))
        found = [
            best
            for blob in blobs[first]
            if (best := self._best_middle(first, blob, blobs, scales)) is not None
        ]
        found.sort(key=lambda one: one[1].error)
        return found[: self._start.people]

    def _best_middle(
        self, first: int, blob: Blob, blobs: Mapping[int, Sequence[Blob]], scales: Sequence[int]
    ) -> tuple[Floats, PersonCandidate] | None:
        """The distance along the first camera's ray at which the blobs of all cameras best match one body on the floor."""
        p, start = self._params, self._start
        eye, ray = rays(self._cameras[first], _frame_px(_middle_px(blob), scales[first])[None])
        best: tuple[Floats, PersonCandidate] | None = None
        for away_m in np.arange(start.nearest_m, start.farthest_m, p.step_m):
            middle_m = np.reshape(eye, 3) + away_m * np.reshape(ray, 3)
            if not 0.0 < middle_m[1] < _HIGHEST_MIDDLE_M:
                continue
            below_m = middle_m * np.array([1.0, 0.0, 1.0])
            error, mine = 0.0, {}
            for i, some in blobs.items():
                at_px = project(self._cameras[i], np.stack([middle_m, below_m]))
                at, foot = (at_px + 0.5) / scales[i] - 0.5
                height_px = self._cameras[i].size_px[1] / scales[i]
                costs = [_off_px2(one, at, foot[1], height_px, p) for one in some]
                k = 0 if i == first else int(np.argmin(costs))
                one = blob if i == first else some[k]
                mine[i] = one
                error += _off_px2(one, at, foot[1], height_px, p)
            if best is None or error < best[1].error:
                best = middle_m, PersonCandidate(below_m, mine, error)
        return best


def upright_about(
    fitter: Fitter, middle_m: Floats, factors: Floats, information: Floats
) -> MotionState:
    """An upright body whose crop centre (see `middle_of`) is at middle_m (3,)."""
    rest_m = fitter.shaper(factors).rest
    root_m = middle_m - (middle_of(rest_m[_HIPS], rest_m[_NECK]) - rest_m[_HIPS])
    local = np.tile(rotations.IDENTITY_XYZW, (N_JOINTS, 1))
    return MotionState(root_m, local, np.zeros(fitter.model.n_pose), factors, information)


def _middle_px(blob: Blob) -> Floats:
    """Centre of a blob [work px]."""
    return np.array([blob.middle_x, 0.5 * (blob.top + blob.bottom)])


def _frame_px(work_px: Floats, image_scale: int) -> Floats:
    out: Floats = (work_px + 0.5) * image_scale - 0.5
    return out


def _off_px2(
    blob: Blob, at_px: Floats, foot_y: float, height_px: float, params: KeypointStartParams
) -> float:
    """Mismatch [work px^2] of a blob with a body centred at at_px (2,) above the floor row foot_y."""
    off = _middle_px(blob) - at_px
    below = blob.bottom - min(foot_y, height_px)
    return float(off @ off + params.bottom_weight * below**2)
