"""Somebody who was in the pictures before the empty room was: the network alone looks for them, place by place.

Before a background that shows them, nobody stands out: the searches of the foreground fail. The network tells a person
without a background, too, and from half a metre beside them. So it looks at some places of the floor in a frame set, first in
one picture; what it takes for the person in most of them stands in for silhouettes. Who passes the tests of the keypoint
initialiser in two of the next frame sets, and moves, is a person. Who walks in later is better found in the foreground, which
is given a second for it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mocapd.clock import nanoseconds
from mocapd.fit.fit_result import Fit
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.geometry.camera_model import centre, project, to_camera
from mocapd.tracking.cues.clothes.camera_views import CameraViews
from mocapd.tracking.cues.clothes.clothes_params import RoomScanParams
from mocapd.tracking.cues.keypoints.keypoint_detection import CameraKeypoints, KeypointDetectors
from mocapd.tracking.initialisers.keypoint_initialiser import (
    KeypointCandidate,
    KeypointInitialiser,
    KeypointPose,
    upright_about,
)
from mocapd.tracking.initialisers.standing_initialiser import Blob, PersonCandidate, blob_within
from mocapd.types import Camera, Floats, Ints
from mocapd.vision.foreground_kernels import BACKGROUND, BEFORE, stands

_ON_FLOOR = np.array([1.0, 0.0, 1.0])


@dataclass(frozen=True, slots=True, eq=False)
class _Suspect:
    """A body about which these cameras may show somebody, for so many more frame sets. is_confirmed: one did."""

    state: MotionState
    cameras: Sequence[int]
    sets: int
    is_confirmed: bool = False


class RoomScan:
    """Keeps which place comes next, and where somebody may be."""

    def __init__(
        self,
        silhouettes: Fitter,
        joints: KeypointDetectors,
        views: CameraViews,
        cameras: Sequence[Camera],
        by_keypoints: KeypointInitialiser,
        params: RoomScanParams,
    ) -> None:
        """silhouettes: a fitter whose body has one region; cameras: those of the views."""
        self._silhouettes, self._joints, self._views = silhouettes, joints, views
        self._by_keypoints, self._params = by_keypoints, params
        middle_y_m = params.middle * silhouettes.model.stature_m
        self._places_m, self._seen_by = places_in_view(cameras, middle_y_m, params)
        self.reset()

    def reset(self) -> None:
        """Begins anew, as nobody has been looked for."""
        self.rest()
        self._patience_s = self._params.first_patience_s

    def rest(self) -> None:
        """Somebody was found."""
        self._next, self._pause_s = 0, self._params.pause_s
        self._patience_s = self._params.patience_s
        self._due_ns: int | None = None  # from the first frame set without a person on
        self._suspect: _Suspect | None = None

    def look(
        self, factors: Floats, information: Floats, t_ns: int
    ) -> tuple[Fit, tuple[str, ...]] | None:
        """A person of this shape in the newest pictures, confirmed by two frame sets, with its cameras' names."""
        if self._suspect is not None:
            return self._look_again(self._suspect)
        if self._due_ns is None:
            self._due_ns = t_ns + nanoseconds(self._patience_s)
        if t_ns < self._due_ns or not len(self._places_m):
            return None
        places = range(self._next, min(self._next + self._params.places, len(self._places_m)))
        self._next = places.stop
        if places.stop == len(self._places_m):  # nobody is here
            self._next, self._due_ns = 0, t_ns + nanoseconds(self._pause_s)
            self._pause_s = min(2.0 * self._pause_s, self._params.longest_pause_s)
        suspect = self._suspect_among(places, factors, information)
        return None if suspect is None else self._look_again(suspect)

    def _suspect_among(
        self, places: Sequence[int], factors: Floats, information: Floats
    ) -> "_Suspect | None":
        """At that of the places where a picture shows somebody best; None if none does, of places that two pictures show."""
        suspects: dict[int, _Suspect] = {}
        shares: dict[int, list[int]] = {}  # by camera, as each has one network
        for place in places:
            cameras = [
                i for i in np.flatnonzero(self._seen_by[place]).tolist() if i in self._views.present
            ]
            if len(cameras) > 1:
                middle_m = self._places_m[place]
                state = upright_about(self._silhouettes, middle_m, factors, information)
                suspects[place] = _Suspect(state, cameras, self._params.sets)
                shares.setdefault(cameras[place % len(cameras)], []).append(place)

        def look(camera: int) -> list[tuple[float, int]]:
            return [
                (spread_m, place)
                for place in shares[camera]
                for spread_m in self._by_keypoints.spreads_m(
                    self._detect(suspects[place].state, [camera])
                )
            ]

        looked = [one for share in self._silhouettes.each(look, shares) for one in share]
        spread_m, place = min(looked, default=(np.inf, 0))
        return suspects[place] if spread_m <= self._params.hopeless_m else None

    def _look_again(self, at: "_Suspect") -> tuple[Fit, tuple[str, ...]] | None:
        """The second time that it is a person, that one."""
        self._suspect = None
        one = self._body_near(at.state, at.cameras)
        if one is None:
            return None
        is_person = (
            self._by_keypoints.is_person(one, self._params.spread_m)
            and self._is_within(one)
            and self._moves(one)
        )
        if is_person and at.is_confirmed:
            return one.fit, tuple(self._views.each[i].name for i in one.person.blobs)
        if at.sets > 1:
            is_confirmed = at.is_confirmed or is_person
            self._suspect = _Suspect(one.fit.state, at.cameras, at.sets - 1, is_confirmed)
        return None

    def _detect(self, state: MotionState, cameras: Sequence[int]) -> dict[int, CameraKeypoints]:
        fitter, joints = self._silhouettes, self._silhouettes.joints(state)
        found = fitter.each(
            lambda i: self._joints.detect(fitter, state, joints, self._views, i, knows_room=False), cameras
        )  # fmt: skip
        return {i: one for i, one in zip(cameras, found, strict=True) if one is not None}

    def _body_near(self, state: MotionState, cameras: Sequence[int]) -> KeypointCandidate | None:
        """The body about a body that most of these cameras show, at least two."""
        posed: KeypointPose | None = None
        found: dict[int, CameraKeypoints] = {}
        for _ in range(self._params.looks):
            found = self._by_keypoints.sure(self._detect(state, cameras), len(cameras))
            posed = self._by_keypoints.pose([one.rays for one in found.values()], state)
            if posed is None:
                return None
            state = posed.state
        blobs = {i: blob for i, one in found.items() if (blob := self._blob(i, one)) is not None}
        if posed is None or len(blobs) < len(found):
            return None
        person = PersonCandidate(state.root_m * _ON_FLOOR, blobs, 0.0)
        return self._by_keypoints.candidate(posed, person, False)

    def _is_within(self, one: KeypointCandidate) -> bool:
        """Whether no picture's side cuts somebody off: who walks in is better found in the foreground, a moment later."""
        for i, blob in one.person.blobs.items():
            (x0, _, x1, _), width_px = blob.roi, self._views.each[i].foreground.shape[1]
            if x0 == 0 or x1 >= width_px - 1:
                return False
        return True

    def _moves(self, one: KeypointCandidate) -> bool:
        """Whether a part of somebody differs from the background in a picture: of a poster or a dummy nothing does."""
        for i, blob in one.person.blobs.items():
            x0, y0, x1, y1 = blob.roi
            here = stands(self._views.each[i].foreground[y0:y1, x0:x1]) & (blob.mask > 0)
            if np.count_nonzero(here) >= self._params.moving_share * np.count_nonzero(blob.mask):
                return True
        return False

    def _blob(self, camera: int, found: CameraKeypoints) -> Blob | None:
        """What the network takes for the person, as a silhouette."""
        is_person = self._views.each[camera].person_in(found.odds, found.crop)
        return blob_within(
            np.where(is_person, BEFORE, BACKGROUND).astype(np.uint8), is_person.astype(np.uint8)
        )


def places_in_view(
    cameras: Sequence[Camera], middle_y_m: float, params: RoomScanParams
) -> tuple[Floats, Ints]:
    """Middles (P,3) of people to look at, first what most cameras show, then what is nearest to the middle of pictures; and
    which cameras (P,C) show each: two and more."""
    p = params
    eyes_m = np.array([centre(camera) for camera in cameras])
    low, high = eyes_m.min(axis=0) - p.farthest_m, eyes_m.max(axis=0) + p.farthest_m
    x, z = (np.arange(low[k], high[k], p.step_m) for k in (0, 2))
    places_m = np.stack(np.broadcast_arrays(x[:, None], middle_y_m, z), axis=-1).reshape(-1, 3)
    shown, off = np.zeros((len(places_m), len(cameras)), bool), np.zeros(len(places_m))
    for i, camera in enumerate(cameras):
        z_m, size_px = to_camera(camera, places_m)[:, 2], np.asarray(camera.size_px)
        at = project(camera, np.where(z_m[:, None] > p.nearest_m, places_m, np.nan)) / size_px
        near = (z_m > p.nearest_m) & (z_m < p.farthest_m)
        shown[:, i] = near & ((at > p.margin) & (at < 1.0 - p.margin)).all(axis=1)
        off += np.where(shown[:, i], np.abs(at - 0.5).max(axis=1), 0.0)
    count = shown.sum(axis=1)
    kept = np.flatnonzero(count > 1)
    order = kept[np.lexsort((off[kept] / count[kept], -count[kept]))]
    return places_m[order], shown[order]
