"""Where the shirt is looked for in a frame set: on the body that it carries, on one that clothes carry, elsewhere."""

from dataclasses import replace

import numpy as np

from mocapd.body.model import BodyModel
from mocapd.clock import nanoseconds, seconds
from mocapd.fit.motion_state import MotionState, predict_state
from mocapd.tracking.base import Probe
from mocapd.tracking.cues.shirt.shirt_cue import ShirtCue, ShirtFound
from mocapd.tracking.track_state import Proportions, TrackState, in_t_pose
from mocapd.tracking.trunk_and_legs import straight_below
from mocapd.types import FrameSet


class ShirtWatch:
    """Remembers the shirt that is not where the body is, as somebody of its own, and when it may look again."""

    def __init__(self, cue: ShirtCue, whole: BodyModel, damping: float) -> None:
        """whole: the body whose trunk the shirt carries; damping: of the motion that a prediction goes on with."""
        self._cue, self._whole, self._damping = cue, whole, damping
        self._params = cue.params
        self.reset()

    def reset(self) -> None:
        """The shirt was seen nowhere."""
        self._next_look_ns = 0
        self.has_looked = False  # in the last frame set
        self.elsewhere: TrackState | None = None
        self.elsewhere_since_ns = 0

    def see(
        self,
        known: TrackState,
        predicted: MotionState,
        wearer: Proportions,
        dt_s: float,
        present: dict[int, float],
        frames: FrameSet,
        turn: int,
        is_believed: bool,
        probe: Probe,
    ) -> ShirtFound | None:
        """Trunk and arms as the shirt shows them; None where it does not. predicted: the body, dt_s after it was known;
        is_believed: the shirt was a moment ago, and is looked for at once."""
        p, cue, t_ns = self._params, self._cue, frames.t_ns
        self.has_looked = True
        if known.trunk is not None:
            found = cue.follow(known, predicted, dt_s, present, frames, turn, probe)
        elif self.elsewhere is not None:
            other = self.elsewhere
            dt_s = max(seconds(t_ns - other.t_ns), 1e-3)
            ahead = predict_state(self._whole, other.motion, dt_s, self._damping)
            found = cue.follow(other, ahead, dt_s, present, frames, turn, probe)
        elif t_ns < self._next_look_ns and not is_believed:
            self.has_looked = False
            return None
        else:
            self._next_look_ns = t_ns + nanoseconds(p.covered_pause_s)
            found = cue.begin(predicted, known.taught_s, present, turn)
            if found is None and cue.is_search_due(t_ns):
                found = cue.search(wearer, present, t_ns, 2.0 * p.covered_pause_s, 0.0, turn)
            probe("shirt.detect")
        if known.by_shirt:
            found = self._surer(found, wearer, present, t_ns, turn, probe)
        else:
            self._keep_elsewhere(found, predicted, wearer, t_ns)
        return found

    def search(
        self, wearer: Proportions, present: dict[int, float], t_ns: int, turn: int
    ) -> ShirtFound | None:
        """Somebody in the shirt, while nobody is known."""
        if not self._cue.is_search_due(t_ns):
            return None
        return self._cue.search(wearer, present, t_ns, self._params.search_pause_s, 0.0, turn)

    def _surer(
        self,
        found: ShirtFound | None,
        wearer: Proportions,
        present: dict[int, float],
        t_ns: int,
        turn: int,
        probe: Probe,
    ) -> ShirtFound | None:
        """What was found, or what a search of all of the pictures finds where that agrees badly."""
        p, better_than = self._params, 0.0
        if not self._cue.is_search_due(t_ns) or (
            found is not None and found.fit.match >= p.uncertain_match
        ):
            return found
        if found is not None:
            better_than = found.fit.match + p.uncertain_gain
            kept = [  # the search uses the same buffers
                replace(v, ids=v.ids.copy(), pixel_weight=v.pixel_weight.copy())
                for v in found.views
            ]
            found = replace(found, views=tuple(kept))
        anew = self._cue.search(wearer, present, t_ns, p.uncertain_pause_s, better_than, turn)
        probe("shirt.detect")
        return found if anew is None else replace(anew, jumped=("left", "right"))

    def _keep_elsewhere(
        self, found: ShirtFound | None, predicted: MotionState, wearer: Proportions, t_ns: int
    ) -> None:
        """Keep the shirt that is not where the body is apart from that body."""
        was, self.elsewhere = self.elsewhere, None
        if found is None:
            return
        apart_m = float(np.linalg.norm(found.motion.root_m - predicted.root_m))
        if apart_m <= self._params.near_m:
            return
        if was is None:
            self.elsewhere_since_ns = t_ns
        motion = self.standing(found, wearer)
        self.elsewhere = TrackState(
            t_ns, motion, (), found.fit, taught_s=found.taught_s, by_shirt=True
        )

    def standing(self, found: ShirtFound, wearer: Proportions) -> MotionState:
        """A whole body of which the shirt alone is known: its legs hang straight down."""
        body = in_t_pose(self._whole, found.motion.root_m, wearer)
        return straight_below(found.motion, body)
