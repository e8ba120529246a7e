"""All cameras of the clothes cue: what each knows of its room and of the body, done for all of them at once."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TypeVar

import cv2
import numpy as np

from mocapd.body.surface import LEFT_ARM, RIGHT_ARM
from mocapd.fit.idmap_renderer import Roi
from mocapd.fit.motion_state import MotionState
from mocapd.fit.solver import Fitter
from mocapd.fit.view import View
from mocapd.fit.work_size import work_size
from mocapd.tracking.cues.clothes.appearance import region_distances
from mocapd.tracking.cues.clothes.camera_view import CameraView, FloorView
from mocapd.tracking.cues.clothes.clothes_params import ClothesParams
from mocapd.types import Bytes, Floats
from mocapd.vision.clip_background import clip_background
from mocapd.vision.foreground_kernels import BACKGROUND, BEFORE, stands

T = TypeVar("T")


class CameraViews:
    """All cameras of a fitter, which may change from frame to frame. present: each present camera's time offset from the
    frame set [s], by index; newcomers: the same of those that are left out of it, see `set_newcomers_aside`."""

    def __init__(self, fitter: Fitter, params: ClothesParams) -> None:
        self.fitter, self._params, self._each = fitter, params, fitter.each
        self.each = [
            CameraView(d.camera.name, work_size(d.camera, d.image_scale), d.image_scale, params)
            for d in fitter.drawings
        ]
        self._floors = [FloorView(d.camera, d.image_scale) for d in fitter.drawings]
        # of a pixel by its foreground label
        self._weights = np.full(256, int(255 * params.soft), np.uint8)
        self._weights[BACKGROUND] = 255
        self.present: dict[int, float] = {}
        self.newcomers: dict[int, float] = {}

    def reset(self) -> None:
        """Forget background and appearance."""
        for view in self.each:
            view.reset()

    def take(self, pictures: Mapping[int, Bytes], present: dict[int, float]) -> None:
        """Stores work pictures (h,w,3) by camera, and `present`."""
        for i, picture in pictures.items():
            self.each[i].take(picture)
        self.present, self.newcomers = present, {}

    def set_newcomers_aside(self) -> None:
        """Leaves the cameras that know no background or no appearance out of this frame set, if others know both: they were
        absent, or did not show the person, when the others learned it."""
        known = {
            i: dt_s
            for i, dt_s in self.present.items()
            if self.each[i].appearance.is_learned and not self.each[i].background.is_new
        }
        if known:
            self.newcomers |= {i: s for i, s in self.present.items() if i not in known}
            self.present = known

    def admit_newcomers(self, state: MotionState, merge: Sequence[int]) -> None:
        """Teaches the newcomers background and appearance, as far as they show a body that fits the other cameras. merge:
        which regions are one, see `Appearance.merge_regions`."""
        newcomers, self.newcomers = self.newcomers, {}
        self.present = dict(sorted((self.present | newcomers).items()))

        def admit(i: int) -> None:
            self._mark(i, state)
            camera = self.each[i]
            if camera.background.is_new:
                camera.background.seed(camera.picture, camera.body)
            if camera.near is None:
                return
            self._distrust_background(i)
            camera.update_foreground()
            self._learn(i, state, self.present[i], camera.near, None)
            camera.appearance.merge_regions(merge)

        self._each(admit, newcomers)

    def learn_room(
        self, pictures_bgr: Mapping[int, Sequence[Bytes]], times_s: Mapping[int, Floats]
    ) -> None:
        """Learns each background from pictures (h,w,3) of these times, by camera, that may always show a person."""
        for i, pictures in pictures_bgr.items():
            self.each[i].background.set_known(*clip_background(pictures, times_s[i]))
            self.each[i].may_hold_body = True

    def distrust_background(self) -> None:
        """Clears the background under a newly found body where it may have been learned from that body."""
        for i in self.present:
            self._distrust_background(i)

    def _distrust_background(self, i: int) -> None:
        camera = self.each[i]
        if camera.may_hold_body:
            camera.background.forget(camera.learned_body())
            camera.may_hold_body = False

    def forget_background(self, state: MotionState) -> None:
        """Clears the background under a body that was in view when the background was first taken."""

        def forget(i: int) -> None:
            self._mark(i, state)
            self.each[i].forget_person()
            self.each[i].update_foreground(everywhere=False)

        self._each(forget, self.present)

    @property
    def are_new(self) -> bool:
        """True if a present camera has no background model yet."""
        return any(self.each[i].background.is_new for i in self.present)

    @property
    def has_appearance(self) -> bool:
        """True if every present camera has learned the wearer's appearance."""
        return all(self.each[i].appearance.is_learned for i in self.present)

    def mark_body(self, state: MotionState | None) -> None:
        """Marks the predicted body in every present picture."""
        self._each(lambda i: self._mark(i, state), self.present)

    def _mark(self, i: int, state: MotionState | None) -> None:
        drawing, dt_s = self.fitter.drawings[i], self.present[i]
        drawn = None if state is None else drawing.render_about(state, dt_s, self._params.margin_px)
        self.each[i].mark_body(drawn)

    def update_foreground(self) -> None:
        """Updates the foreground masks of whole pictures."""
        self._each(lambda i: self.each[i].update_foreground(), self.present)

    def renew_before(self, searches_everywhere: bool) -> None:
        """Updates the foreground masks. searches_everywhere: in whole pictures, and with a search for ghosts."""
        self._each(lambda i: self._renew_before(i, searches_everywhere), self.present)

    def _renew_before(self, i: int, searches_everywhere: bool) -> None:
        self.each[i].update_foreground(everywhere=searches_everywhere)
        if searches_everywhere:
            self._remove_ghosts_of(i)

    def remove_ghosts(self) -> None:
        """Moves ghosts from the foreground to the background; see `RoomBackground`. The marked body was rendered last. What
        the network takes for the person is none, be it drawn as an arm or not drawn at all: a limb that the fit lost would be
        learned with the room, and not be found again."""
        self._each(self._remove_ghosts_of, self.present)

    def _remove_ghosts_of(self, i: int) -> None:
        camera, arms = self.each[i], np.zeros_like(self.each[i].drawn)
        person = camera.person_by_network()
        if camera.near is not None:
            x0, y0, x1, y1 = camera.near
            ids, triangles = self.fitter.drawings[i].last(camera.near)
            part = self.fitter.model.part[np.maximum(triangles, 0)]
            arms[y0:y1, x0:x1] = (ids > 0) & ((part == LEFT_ARM) | (part == RIGHT_ARM))
            arms[person] = 0
        body = camera.drawn | person
        camera.background.remove_ghosts(camera.picture, camera.foreground, body, arms)

    def prepare(
        self, state: MotionState, searches_everywhere: bool, also: Callable[[int], T]
    ) -> tuple[list[View], list[T]]:
        """Runs `mark_body`, `renew_before`, `classify` and `also` of a predicted body, each camera in one task:
        synchronising threads after every stage gains nothing."""

        def process(i: int) -> tuple[View | None, T]:
            self._mark(i, state)
            self._renew_before(i, searches_everywhere)
            result = also(i)
            return self._classify(i, state, marked=True), result

        done = self._each(process, self.present)
        return self._clear(view for view, _ in done), [
            result
            for i, (_, result) in zip(self.present, done, strict=True)
            if not self.each[i].is_covered
        ]

    def classify(self, state: MotionState) -> list[View]:
        """Classifies every present picture into regions about the predicted body, and renders the body into each."""
        return self._clear(self._each(lambda i: self._classify(i, state), self.present))

    def _clear(self, views: Iterable[View | None]) -> list[View]:
        """Those of cameras that nothing covers; all if each is covered."""
        there = [view for view in views if view is not None]
        return [view for view in there if not self.each[view.index].is_covered] or there

    def _classify(self, i: int, state: MotionState, marked: bool = False) -> View | None:
        """marked: the state was drawn last, to mark the body."""
        p = self._params
        drawing, camera, dt_s = self.fitter.drawings[i], self.each[i], self.present[i]
        roi = camera.near if marked else drawing.region(state, dt_s, p.margin_px)
        if roi is None:
            return None
        x0, y0, x1, y1 = roi
        before = np.ascontiguousarray(camera.foreground[y0:y1, x0:x1])
        drawn = drawing.last(roi)[0] if marked else drawing.render(state, dt_s, roi)
        beside = drawn == 0
        stand = np.count_nonzero(stands(before) & beside)
        camera.is_covered = bool(stand > p.covered_share * np.count_nonzero(beside))
        odds = np.ascontiguousarray(camera.person_odds[y0:y1, x0:x1])
        if camera.has_new_odds:  # those of an earlier picture are where a limb was
            before[(before == BACKGROUND) & (odds > p.room_coloured)] = BEFORE
        ids = camera.appearance.classify(
            np.ascontiguousarray(camera.picture[y0:y1, x0:x1]),
            before,
            region_distances(drawn),
            self._floors[i].near(state.root_m, roi),
            odds,
        )
        weights = np.asarray(cv2.LUT(before, self._weights), np.uint8)
        return View(i, roi, ids, weights, dt_s)

    def silhouettes(self, state: MotionState) -> list[View]:
        """The foreground of every present picture about a body without an appearance model."""
        views = []
        for i, dt_s in self.present.items():
            drawing, camera = self.fitter.drawings[i], self.each[i]
            roi = drawing.region(state, dt_s, self._params.margin_px)
            if roi is None:
                continue
            x0, y0, x1, y1 = roi
            ids = ((camera.foreground == BEFORE) & (camera.body > 0))[y0:y1, x0:x1].astype(np.uint8)
            views.append(View(i, roi, ids, np.full(ids.shape, 255, np.uint8), dt_s))
        return views

    def learn_first_appearance(self, state: MotionState) -> None:
        """Learns the first colours of a body."""
        for i, dt_s in self.present.items():
            roi = self.fitter.drawings[i].region(state, dt_s, self._params.margin_px)
            if roi is not None:
                self._learn(i, state, dt_s, roi, None)

    def _learn(
        self, index: int, state: MotionState, dt_s: float, roi: Roi, ids: Bytes | None
    ) -> None:
        camera = self.each[index]
        x0, y0, x1, y1 = roi
        camera.appearance.learn(
            np.ascontiguousarray(camera.picture[y0:y1, x0:x1]),
            self.fitter.drawings[index].render(state, dt_s, roi),
            np.ascontiguousarray(camera.foreground[y0:y1, x0:x1]),
            ids,
        )

    def mark_unknown(self) -> None:
        """Marks the whole foreground as a possible person."""
        for i in self.present:
            camera = self.each[i]
            if not camera.background.is_new:
                cv2.dilate(
                    stands(camera.foreground).astype(np.uint8),
                    camera.body_margin,
                    dst=camera.body,
                )

    def learn(self, state: MotionState | None, views: Sequence[View], ticks: int = 1) -> None:
        """Learns the colours of a body that fits these views, and each background outside the marked body, unless the
        background may still hold an undetected person. ticks: number of 1/30 s that passed."""
        shows = {view.index: view for view in views}

        def learn(i: int) -> None:
            if state is not None and i in shows:
                view = shows[i]
                self._learn(i, state, view.dt_s, view.roi, view.ids)
            camera = self.each[i]
            if not camera.may_hold_body:
                camera.learn_background(state is not None, ticks)

        self._each(learn, self.present)

    def outline_contrast(self) -> float:
        """Ratio of the image gradient on the marked body's outline to that near it; about 1 without a person there."""
        on_outline = off_outline = 0.0
        for i in self.present:
            camera = self.each[i]
            if camera.drawn.any():
                on, off = camera.outline_edges()
                on_outline += on
                off_outline += off
        return on_outline / max(off_outline, 1e-3)

    def seed_background(self) -> None:
        """Takes everything outside the marked body for the background, where none is known yet."""

        def seed(i: int) -> None:
            camera = self.each[i]
            if camera.background.is_new:
                camera.background.seed(camera.picture, camera.body)

        self._each(seed, self.present)

    def names(self, views: Sequence[View]) -> tuple[str, ...]:
        """Of the cameras of these views."""
        return tuple(self.each[v.index].name for v in views)

    def evidence(self, views: list[View]) -> tuple[Mapping[str, Bytes], Mapping[str, Roi]]:
        """The classified regions and their places in the frames, by camera."""
        ids = {self.each[v.index].name: v.ids for v in views}
        where = {}
        for v in views:
            k = self.each[v.index].image_scale
            x0, y0, x1, y1 = v.roi
            where[self.each[v.index].name] = (k * x0, k * y0, k * x1, k * y1)
        return ids, where
