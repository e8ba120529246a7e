"""Locates the shirt in a frame set: on the body that it carries, on a body that clothes carry, or elsewhere."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.motion_state import MotionState
from mocapd.fit.terms.joint_term import JointTerm
from mocapd.tracking.base import Probe
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue, ShirtEstimate
from mocapd.tracking.track_state import BodyShapeEstimate, TrackState, t_pose_state
from mocapd.tracking.trunk_and_legs import with_straight_legs


class ShirtLocator:
    """Keeps a separate track of a shirt that is away from the body, and the time of the next attempt."""

    def __init__(self, cue: ShirtCue, whole: BodyModel, damping: float) -> None:
        """whole: the body whose trunk the shirt carries; damping: of the motion that a prediction goes on with."""
        self._cue, self._whole, self._damping = cue, whole, damping
        self._params = cue.params
        self.reset()

    def reset(self) -> None:
        """Forgets the separate track."""
        self._next_attempt_ns = 0
        self._missing_ns: int | None = None  # since the first attempt that failed
        self.has_searched = False  # in the last frame set
        self.separate_track: TrackState | None = None
        self.separate_since_ns = 0

    def locate(
        self,
        state: TrackState,
        predicted: MotionState,
        wearer: BodyShapeEstimate,
        dt_s: float,
        present: dict[int, float],
        t_ns: int,
        frame_index: int,
        is_trusted: bool,
        keypoints: Sequence[JointTerm],
        probe: Probe,
    ) -> ShirtEstimate | None:
        """Trunk and arms from the shirt; None if it is not found. predicted: the body, dt_s after `state`; is_trusted:
        the shirt was trusted a moment ago, so a failed fit is repeated at once; keypoints: of the body."""
        cue, self.has_searched = self._cue, True
        if state.trunk is not None:
            found = cue.follow(state, predicted, dt_s, present, keypoints, frame_index, probe)
        elif self.separate_track is not None:
            separate = self.separate_track
            dt_s = max(seconds(t_ns - separate.t_ns), 1e-3)
            extrapolated = separate.predicted(self._whole, dt_s, self._damping)
            found = cue.follow(separate, extrapolated, dt_s, present, (), frame_index, probe)
        elif t_ns < self._next_attempt_ns and not is_trusted:
            self.has_searched = False
            return None
        else:
            if self._missing_ns is None:
                self._missing_ns = t_ns
            pause_s = self._pause_s(seconds(t_ns - self._missing_ns))
            self._next_attempt_ns = t_ns + nanoseconds(pause_s)
            found = cue.start_from(predicted, state.taught_s, present, frame_index)
            if found is None and cue.is_search_due(t_ns):
                found = cue.search(wearer, present, t_ns, 2.0 * pause_s, 0.0, frame_index)
            probe("shirt.detect")
        if found is not None:
            self._missing_ns = None
        if state.by_shirt:
            found = self._redetect_if_uncertain(found, wearer, present, t_ns, frame_index, probe)
        else:
            self._update_separate_track(found, predicted, wearer, t_ns)
        return found

    def _pause_s(self, missing_s: float) -> float:
        """Until the next attempt: who has worn no shirt for long hardly puts one on."""
        p = self._params
        pause_s = max(p.covered_share * missing_s, p.covered_pause_s)
        return min(pause_s, p.most_covered_pause_s)

    def search(
        self, wearer: BodyShapeEstimate, present: dict[int, float], t_ns: int, frame_index: int
    ) -> ShirtEstimate | None:
        """Searches for the shirt while no body is tracked."""
        if not self._cue.is_search_due(t_ns):
            return None
        return self._cue.search(
            wearer, present, t_ns, self._params.search_pause_s, 0.0, frame_index
        )

    def _redetect_if_uncertain(
        self,
        found: ShirtEstimate | None,
        wearer: BodyShapeEstimate,
        present: dict[int, float],
        t_ns: int,
        frame_index: int,
        probe: Probe,
    ) -> ShirtEstimate | None:
        """The estimate, or a better one from a search of all pictures if its match is poor."""
        p, better_than = self._params, 0.0
        if not self._cue.is_search_due(t_ns) or (
            found is not None and found.fit.match >= p.uncertain_match
        ):
            return found
        if found is not None:
            better_than = found.fit.match + p.uncertain_gain
            copies = [  # the search uses the same buffers, and draws other bodies
                replace(v, ids=v.ids.copy(), pixel_weight=v.pixel_weight.copy())
                for v in found.views
            ]
            found = replace(found, views=tuple(copies), redraw=True)
        detected = self._cue.search(
            wearer, present, t_ns, p.uncertain_pause_s, better_than, frame_index
        )
        probe("shirt.detect")
        return found if detected is None else replace(detected, jumped=("left", "right"))

    def _update_separate_track(
        self,
        found: ShirtEstimate | None,
        predicted: MotionState,
        wearer: BodyShapeEstimate,
        t_ns: int,
    ) -> None:
        """Keeps a shirt that is away from the body as a track of its own."""
        previous, self.separate_track = self.separate_track, None
        if found is None:
            return
        apart_m = float(np.linalg.norm(found.motion.root_m - predicted.root_m))
        if apart_m <= self._params.near_m:
            return
        if previous is None:
            self.separate_since_ns = t_ns
        motion = self.upright_body(found, wearer)
        self.separate_track = TrackState(
            t_ns, motion, (), found.fit, taught_s=found.taught_s, by_shirt=True
        )

    def upright_body(self, found: ShirtEstimate, wearer: BodyShapeEstimate) -> MotionState:
        """A whole body for trunk and arms of the shirt, with legs that hang straight down."""
        body = t_pose_state(self._whole, found.motion.root_m, wearer)
        return with_straight_legs(found.motion, body)
