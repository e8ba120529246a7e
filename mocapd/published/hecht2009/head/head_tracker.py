"""Tracks the head: detection by its face, then a particle filter in all views, and detection again after a loss.

Hecht, Azad and Dillmann, Markerless Human Motion Tracking with a Flexible Model and Appearance Learning, ICRA 2009,
section III.B, in world coordinates and with every camera at once: each particle is a head in space, weighted by the
colours and outline that it explains in each picture, by detected faces, and by its distance from a close pair.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mocapd.body.arrays import camera_arrays
from mocapd.geometry.camera_model import centre, project
from mocapd.published.hecht2009.face.face_detection import FaceBox
from mocapd.published.hecht2009.face.lbp_cascade_kernels import CascadeArrays
from mocapd.published.hecht2009.head.face_placing import Depth, PlacedFace
from mocapd.published.hecht2009.head.face_search import FaceCandidate, FaceSearch
from mocapd.published.hecht2009.head.head_cloud import (
    Cloud,
    cloud_about,
    cloud_at,
    is_far,
    moments,
    observations,
    predict,
    propose,
    resampled,
)
from mocapd.published.hecht2009.head.head_evidence import HeadEvidence, HeadGuess
from mocapd.published.hecht2009.head.head_outline import outlined_head
from mocapd.published.hecht2009.head.head_params import (
    FARTHEST_M,
    LEARN_SUPPORT,
    NEAREST_M,
)
from mocapd.published.hecht2009.head.head_particle_kernels import score_observations
from mocapd.published.hecht2009.head.head_track import HeadPicture, HeadState, HeadTrack
from mocapd.published.hecht2009.head.head_views import HeadView, have_baseline, head_views
from mocapd.published.hecht2009.resampling import normalised_weights
from mocapd.types import Camera, Floats

_OUTLIER = 0.02  # share of measurements that are of something else
_LEAST_LOOKS = 2  # detections of a face
_OUTLINE_LOOKS = 6  # with a head outline before the background and no detected face
_COAST_S = 0.6  # without a face, colours or distance that agree
_LEAST_SUPPORT = 0.5  # of colours and outline together, at the best place
_FACING_S = 0.4  # validity of a detected face for the person's facing direction
_START_ACROSS = 0.25  # of the box's side: spread of the first particles across the ray
_SEARCH_AGAIN_S = 1.0  # without its face before the search for another one starts
_HAND_OVER_S = 2.0  # without its face before another one, as near, replaces it
_AS_NEAR = 1.25
_ALONE_S = 0.4  # without its face in some view before a search along another view's ray
_CHECK_S = 0.25  # between two such searches
_APART_M = 0.3  # a face that is farther from the tracked head belongs to another


class HeadTracker:
    """The state between steps: the particles, the head's colours and the search for faces."""

    def __init__(
        self,
        cameras: Sequence[Camera],
        stature_m: float,
        cascade: CascadeArrays,
        seed: int = 0,
    ) -> None:
        """cascade: of frontal faces; seed: of everything random, so that the same pictures give the same track."""
        self._cameras, self._stature_m, self._seed = tuple(cameras), stature_m, seed
        self._arrays = [camera_arrays(camera) for camera in cameras]
        self._search = FaceSearch(cascade, stature_m)
        self._evidence = HeadEvidence(len(self._cameras), cascade, stature_m)
        apart = [have_baseline(a, b) for i, a in enumerate(cameras) for b in cameras[:i]]
        self._by_size = len(self._cameras) == 1 or not all(apart)
        self.reset()

    def reset(self, near_m: Floats | None = None) -> None:
        """Reset; near_m (3,): the head's middle from another tracker, as the start."""
        self._rng = np.random.default_rng(self._seed)
        self._search.reset()
        self._evidence.reset()
        self._cloud: Cloud | None = None
        self._faceless_s = self._unsupported_s = 0.0
        self._outlines_m: list[Floats] = []
        self._since_check_s = 0.0
        self._box_age_s = [0.0] * len(self._cameras)
        self._yaw_rad: float | None = None
        self._near_m = near_m
        if near_m is not None:
            self._cloud = cloud_at(near_m, 0.05**2 * np.eye(3), self._rng)

    def step(self, pictures: Sequence[HeadPicture], dt_s: float) -> HeadTrack:
        """The head in these pictures, one for each camera, dt after those before."""
        views = head_views(self._cameras, self._arrays, pictures)
        self._search.remember(views, dt_s)
        if self._near_m is not None and views:
            # the surface there is the head, without a detected face
            self._evidence.learn_first(
                views, PlacedFace(self._near_m, 0.05, Depth.MEETING, {}, 1.0)
            )
            self._faceless_s = _FACING_S + 1e-6
            self._near_m = None
        if self._cloud is not None:
            track = self._filter_step(self._cloud, views, dt_s)
            if self._faceless_s > _SEARCH_AGAIN_S and self._is_doubtful(track):
                self._search.step(views, dt_s)
                self._hand_over(track, views)
            else:
                self._search.candidates.clear()
            if track is not None:
                return track
        else:
            self._search.step(views, dt_s)
        return self._found(views)

    def _found(self, views: Sequence[HeadView]) -> HeadTrack:
        """The best detected face; starts to track it if it is live and of a head's size."""
        if self._search.are_swapped:
            return HeadTrack(HeadState.LOST)
        heads = [(c, c.placed) for c in self._search.candidates if c.placed and self._is_head(c, c.placed)]  # fmt: skip
        if not heads:
            return self._find_by_outline(views)
        best, placed = min(heads, key=lambda c: (c[0].alive is not True, self._away_m(c[0], c[1])))
        if self._may_start(best):
            self._start(best, placed, views)
            return self._track_of_face(HeadState.TRACKED, best, placed)
        return self._track_of_face(HeadState.FOUND, best, placed)

    def _find_by_outline(self, views: Sequence[HeadView]) -> HeadTrack:
        """A head without a detected face: a head outline before the background in several successive looks."""
        outlined = outlined_head(views, self._stature_m)
        lost = HeadTrack(HeadState.LOST)
        if outlined is None:
            self._outlines_m = []
            return lost
        index, box, placed = outlined
        last = self._outlines_m[-1] if self._outlines_m else placed.middle_m
        if float(np.linalg.norm(placed.middle_m - last)) > _APART_M:
            self._outlines_m = []
        self._outlines_m.append(placed.middle_m)
        if len(self._outlines_m) < _OUTLINE_LOOKS:
            return lost
        of = FaceCandidate(index, box, 0.0, len(self._outlines_m), True, placed, 0.0)
        self._start(of, placed, views)
        self._faceless_s = _FACING_S + 1e-6
        return replace(self._track_of_face(HeadState.TRACKED, of, placed), yaw_rad=None)

    def _is_head(self, of: FaceCandidate, placed: PlacedFace) -> bool:
        """True for a face that was detected more than once, has a head's size, and a distance on which a pair agrees. One
        camera, or two in one place, use the size only."""
        is_placed = self._by_size or placed.depth is not Depth.SIZE
        often = of.looks >= _LEAST_LOOKS
        return often and is_placed and placed.is_head_sized

    def _may_start(self, of: FaceCandidate) -> bool:
        return of.unseen_s == 0.0 and of.alive is True

    def _away_m(self, of: FaceCandidate, placed: PlacedFace) -> float:
        return float(np.linalg.norm(placed.middle_m - centre(self._cameras[of.view])))

    def _start(self, of: FaceCandidate, placed: PlacedFace, views: Sequence[HeadView]) -> None:
        ray = placed.middle_m - centre(self._cameras[of.view])
        ray = ray / np.linalg.norm(ray)
        along = np.outer(ray, ray)
        focal_px = float(self._cameras[of.view].K[0, 0])
        across_m = _START_ACROSS * of.box.size_px * self._away_m(of, placed) / focal_px
        covariance = placed.sigma_along_m**2 * along + across_m**2 * (np.eye(3) - along)
        self._cloud = cloud_at(placed.middle_m, covariance, self._rng)
        self._faceless_s = self._unsupported_s = 0.0
        self._evidence.reset()
        self._evidence.learn_first(views, placed)
        self._outlines_m = []
        self._search.candidates.clear()

    def _track_of_face(self, state: HeadState, of: FaceCandidate, placed: PlacedFace) -> HeadTrack:
        yaw = self._towards_rad(placed.middle_m, of.view)
        boxes = tuple(placed.boxes.get(i) for i in range(len(self._cameras)))
        return HeadTrack(state, placed.middle_m, placed.sigma_along_m, yaw, boxes)

    def _towards_rad(self, middle_m: Floats, camera: int) -> float:
        """The yaw of a head that looks at a camera."""
        way = centre(self._cameras[camera]) - middle_m
        return float(np.arctan2(way[0], way[2]))

    def _filter_step(
        self, before: Cloud, views: Sequence[HeadView], dt_s: float
    ) -> HeadTrack | None:
        """The filter's step; None, and the cloud is dropped, after too long without agreeing evidence."""
        cloud = predict(before, dt_s, self._rng)
        guess = self._guess(cloud)
        sighting = self._evidence.observe(views, guess)
        measured = observations(sighting.parts)
        if sighting.is_complete and is_far(cloud, measured):
            # a face with its distance determines the position, but the particles drifted away from it
            cloud = cloud_about(measured, cloud, self._rng)
        cloud, log_weight = propose(cloud, measured, self._rng)
        log_weight += self._evidence.log_likelihood(views, cloud, guess.middle_m)
        score_observations(
            np.ascontiguousarray(cloud.place_m), measured.means_m, measured.information,
            _OUTLIER, log_weight,
        )  # fmt: skip
        weight = normalised_weights(log_weight)
        middle, covariance = moments(cloud.place_m, weight)
        velocity = weight @ cloud.velocity_m_s
        self._cloud = resampled(cloud, weight, self._rng)
        has_face = any(box is not None for box in sighting.boxes)
        self._check_place(views, sighting.boxes, dt_s)
        support = self._evidence.support(views, middle, velocity)
        self._faceless_s = 0.0 if has_face else self._faceless_s + dt_s
        agrees = has_face or support >= _LEAST_SUPPORT
        self._unsupported_s = 0.0 if agrees else self._unsupported_s + dt_s
        lost = self._unsupported_s > _COAST_S or not self._in_reach(middle)
        if lost or self._search.are_swapped:
            self._cloud = None
            return None
        self._evidence.learn(views, middle, velocity, sighting.boxes, dt_s)
        facing = self._faceless_s <= _FACING_S
        self._yaw_rad = self._evidence.yaw_rad(views, middle, velocity) if facing else None
        along_m = self._sigma_along_m(middle, covariance)
        return HeadTrack(HeadState.TRACKED, middle, along_m, self._yaw_rad, sighting.boxes, support)

    def _check_place(
        self, views: Sequence[HeadView], boxes: Sequence[FaceBox | None], dt_s: float
    ) -> None:
        """Search for a face that only some views confirm along its ray in the other views."""
        self._since_check_s += dt_s
        for i, box in enumerate(boxes):
            self._box_age_s[i] = 0.0 if box is not None else self._box_age_s[i] + dt_s
        if max(self._box_age_s) < _ALONE_S or self._since_check_s < _CHECK_S:
            return
        for view in views:
            box = boxes[view.index]
            if box is None:
                continue
            self._since_check_s = 0.0
            placed = self._search.place(view, box, views)
            if placed.depth is Depth.MEETING and placed.is_head_sized:
                covariance = placed.sigma_along_m**2 * np.eye(3)
                self._cloud = cloud_at(placed.middle_m, covariance, self._rng)

    def _sigma_along_m(self, middle: Floats, covariance: Floats) -> float:
        """One standard deviation along the nearest camera's ray [m]."""
        rays = [middle - centre(camera) for camera in self._cameras]
        ray = min(rays, key=np.linalg.norm)
        ray = ray / np.linalg.norm(ray)
        return float(np.sqrt(ray @ covariance @ ray))

    def _guess(self, cloud: Cloud) -> HeadGuess:
        middle, covariance = moments(cloud.place_m)
        along_m = self._sigma_along_m(middle, covariance)
        return HeadGuess(middle, cloud.velocity_m_s.mean(axis=0), along_m)

    def _in_reach(self, middle: Floats) -> bool:
        """True if the place is in view of a camera, not too near and not too far."""
        for camera in self._cameras:
            away_m = float(np.linalg.norm(centre(camera) - middle))
            x, y = project(camera, middle)
            inside = 0 <= x < camera.size_px[0] and 0 <= y < camera.size_px[1]
            if inside and 0.5 * NEAREST_M < away_m < 1.3 * FARTHEST_M:
                return True
        return False

    def _is_doubtful(self, track: HeadTrack | None) -> bool:
        """True if the tracked object may be no head."""
        return track is not None and track.support < LEARN_SUPPORT

    def _hand_over(self, track: HeadTrack | None, views: Sequence[HeadView]) -> None:
        """Switch to another face when the tracked head has had none for long and the other is as near."""
        if track is None or track.middle_m is None or self._faceless_s < _HAND_OVER_S:
            return
        mine_m = min(float(np.linalg.norm(track.middle_m - centre(c))) for c in self._cameras)
        for candidate in self._search.candidates:
            placed = candidate.placed
            if placed is None or not self._is_head(candidate, placed):
                continue
            apart_m = float(np.linalg.norm(placed.middle_m - track.middle_m))
            as_near = self._away_m(candidate, placed) < _AS_NEAR * mine_m
            if self._may_start(candidate) and apart_m > _APART_M and as_near:
                self._start(candidate, placed, views)
                return
