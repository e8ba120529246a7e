"""Who stands before the background and is to be tracked: a person, and of several the nearest."""

from collections.abc import Sequence

import numpy as np

from mocapd.clock import nanoseconds
from mocapd.fit.solver import Fit, Fitter
from mocapd.fit.terms.floor_term import FloorTerm
from mocapd.geometry.camera_model import centre
from mocapd.trackers.flex.camera_views import CameraViews
from mocapd.trackers.flex.params import StartParams
from mocapd.trackers.flex.stance import blobs_of, first_fit, is_standing, standing
from mocapd.types import Camera, Floats


class LookTimes:
    """When to look. Where a look takes long, others get as many pictures between two looks as it cost them."""

    def __init__(self, params: StartParams) -> None:
        self._pause_ns = nanoseconds(params.pause_s)
        self._most_ns = nanoseconds(params.most_rest_s)
        self._next_ns = 0
        self._looked_ns: int | None = None  # until the frame set after it has come

    def came(self, t_ns: int) -> None:
        """A frame set: the first after a look tells how long that took."""
        if self._looked_ns is None:
            return
        took_ns, self._looked_ns = t_ns - self._looked_ns, None
        if took_ns > self._pause_ns:
            self._next_ns = t_ns + min(took_ns, self._most_ns)

    def is_due(self, t_ns: int) -> bool:
        """Of a frame set that came, in which nobody is known; True: it is looked now."""
        if t_ns < self._next_ns:
            return False
        self._next_ns, self._looked_ns = t_ns + self._pause_ns, t_ns
        return True


class PersonSearch:
    """Remembers when it may look again, and where somebody was likely at the last look."""

    def __init__(
        self,
        silhouettes: Fitter,
        floor: FloorTerm,
        views: CameraViews,
        cameras: Sequence[Camera],
        params: StartParams,
    ) -> None:
        """silhouettes: a fitter whose body is of one colour; cameras: those of the views."""
        self._silhouettes, self._floor, self._views = silhouettes, floor, views
        self._cameras, self._params = cameras, params
        self.reset()

    def reset(self) -> None:
        """Look at once, and remember nobody."""
        self.times = LookTimes(self._params)
        self._likely_m: list[Floats] = []

    def look(
        self, factors: Floats, information: Floats, t_ns: int
    ) -> tuple[Fit, tuple[str, ...]] | None:
        """Somebody of these proportions, and the cameras that show them; None: nobody, or it is not time to look."""
        p, views = self._params, self._views
        if views.are_new or not self.times.is_due(t_ns):
            return None
        views.mark_body(None)
        views.stand_before()
        views.take_uncovered()
        fits = [
            one
            for shadows in (False, True)
            for one in self._standing(factors, information, shadows)
        ]
        likely = [
            one
            for one in fits
            if one[0].explained >= p.likely_explained and is_standing(self._silhouettes, one[0])
        ]
        last, self._likely_m = self._likely_m, [fit.state.root_m for fit, _ in likely]
        if not likely:
            return None
        # who is nearer wants to be tracked: a passer-by is seldom in front
        fit, names = max(
            likely, key=lambda one: one[0].explained - p.farther_per_m * self._away_m(one[0])
        )
        again = any(np.linalg.norm(fit.state.root_m - one) < p.same_place_m for one in last)
        return None if fit.explained < p.accept_explained and not again else (fit, names)

    def _standing(
        self, factors: Floats, information: Floats, shadows: bool
    ) -> list[tuple[Fit, tuple[str, ...]]]:
        """People before the background, and the cameras that show them; shadows: with what may be one."""
        p, views = self._params, self._views
        blobs = {i: blobs_of(views.each[i].before, shadows, p) for i in views.present}
        smaller = [one.image_scale for one in views.each]
        stature_m = self._silhouettes.model.stature_m
        return [
            (
                first_fit(self._silhouettes, who, views.present, factors, information, (self._floor,), p),
                tuple(views.each[i].name for i in who.blobs),
            )
            for who in standing(blobs, self._cameras, smaller, stature_m, p)[: p.people]
        ]  # fmt: skip

    def _away_m(self, fit: Fit) -> float:
        """From the cameras, on average."""
        eyes = [centre(camera) for camera in self._cameras]
        return float(np.linalg.norm(np.array(eyes) - fit.state.root_m, axis=1).mean())
