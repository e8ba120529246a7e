"""Hypothesis search for a leg that disagrees with the pictures: sample, score and refine other poses.

A knee that comes up in a tenth of a second is out of the fit's reach, and a leg that slipped onto the other one stays there.
As for arms (`arm_search.py`): mirror images in depth, a cloud about the present pose, and poses that legs have.
"""

from collections.abc import Sequence
from functools import partial

import numpy as np

from mocapd.body.areas import Area
from mocapd.body.pose_space import SIDES
from mocapd.fit.fit_params import LegSearchParams
from mocapd.fit.fit_result import Fit
from mocapd.fit.limbs.arm_samples import Arm, leg_of, place_samples
from mocapd.fit.limbs.limb_candidates import best_poses, candidates, part, spread, turned_rad2
from mocapd.fit.limbs.limb_fits import cheapest_fit, with_limb
from mocapd.fit.limbs.limb_scores import PX_OF_M2, added_in_views
from mocapd.fit.motion_state import MotionState
from mocapd.fit.priors.pose_prior import seldom, unusual_leg, usual_leg
from mocapd.fit.solver import Fitter
from mocapd.fit.terms.term import Term
from mocapd.fit.view import View
from mocapd.geometry import rotations
from mocapd.types import Floats

_AREAS = {
    "left": [Area.LEFT_THIGH, Area.LEFT_SHIN],
    "right": [Area.RIGHT_THIGH, Area.RIGHT_SHIN],
}
_LIBRARY = 1024
_IN_SIGHT = 0.02  # of all drawn pixels; the search skips a leg with fewer


class LegSearch:
    """Tries other poses of legs that the pictures do not confirm."""

    def __init__(self, fitter: Fitter, params: LegSearchParams) -> None:
        """fitter: of a whole body with labelled legs."""
        self.fitter, self.params = fitter, params
        self.legs = {side: leg_of(fitter.model, fitter.labels, side) for side in SIDES}
        u = spread(_LIBRARY)
        near = np.where(np.arange(_LIBRARY) % 2, 1.2, 0.5)[:, None]
        self._cloud = (2.0 * u - 1.0) * near * np.array([1.2, 0.4, 0.5, 1.2, 0.1, 0.1])
        self._library = {side: _library(u, side, params.squats) for side in SIDES}

    def rehearse(self, state: MotionState, views: Sequence[View]) -> None:
        """Warm up: compile or load the search's kernels before the first uncertain leg."""
        for leg in self.legs.values():
            self._scores(state, leg, views, self._candidates(state, leg, views, 0)[:1])

    def improve(
        self,
        fit: Fit,
        views: Sequence[View],
        dt_s: float,
        turn: int,
        terms: Sequence[Term] = (),
        motion: Floats | None = None,
    ) -> tuple[Fit, tuple[str, ...]]:
        """A better fit, if another pose of an uncertain leg gives one, and the sides that changed.

        turn: a running number; each turn tries another part of the low-discrepancy sets; terms, motion: of every fit.
        """
        p = self.params
        changed = []
        refit = partial(
            self.fitter.fit, views=views, dt_s=dt_s, iterations=3, fine=1, motion=motion, terms=terms
        )  # fmt: skip
        for side, leg in self.legs.items():
            if confirmed_share(side, fit) >= p.uncertain:
                continue
            tries = self._candidates(fit.state, leg, views, turn)
            scores = self._scores(fit.state, leg, views, tries)
            best = best_poses(tries[:, :2], scores, p.fits)
            starts = [with_limb(fit.state, leg, tries[n]) for n in best]
            cost = partial(self._cost, leg, tries[0])
            better = cheapest_fit(fit, starts, refit, cost, cost(fit) - p.gain)
            if better is not fit:
                fit = better
                changed.append(side)
        return fit, tuple(changed)

    def _candidates(self, state: MotionState, leg: Arm, views: Sequence[View], turn: int) -> Floats:
        """Local rotations (N,3,4) of thigh, shank and foot to try; the first is the present pose."""
        p = self.params
        cloud = part(self._cloud, turn, p.cloud)
        library = part(self._library[leg.side], turn, p.library)
        return candidates(self.fitter, state, leg, views, cloud, library, first=0)

    def _scores(self, state: MotionState, leg: Arm, views: Sequence[View], tries: Floats) -> Floats:
        """Image score of each hypothesis outside the rest of the body, less its penalties (N,) [work px]."""
        p = self.params
        samples = place_samples(self.fitter.shaper(state.factors), leg, leg.labelled)
        none = np.zeros(len(tries))
        scores = added_in_views(self.fitter, state, leg, views, samples, tries, p.empty, none)
        away_rad2 = turned_rad2(tries[:, :2], tries[0, :2])
        unusual = p.unusual_px * seldom(unusual_leg(tries, leg.side), p.tail)
        out: Floats = PX_OF_M2 * scores - unusual - p.farther_px * away_rad2
        return out

    def _cost(self, leg: Arm, here_xyzw: Floats, fit: Fit) -> float:
        """Cost of a fit, with the prior on its leg pose: unusual, or far from here (3,4)."""
        p = self.params
        there = fit.state.local_xyzw[leg.chain[:3]]
        away_rad2 = float(turned_rad2(there[None, :2], here_xyzw[:2])[0])
        unusual = float(seldom(unusual_leg(there[None], leg.side), p.tail)[0])
        return fit.cost_for_any_pose + (p.unusual_cost * unusual + p.farther_px * away_rad2)


def confirmed_share(side: str, fit: Fit) -> float:
    """0..1: share of its pixels that the pictures confirm, of the worse of thigh and shank; 1 for what is hardly in sight."""
    mine = _AREAS[side]
    asked = fit.visible[mine] + fit.unexplained[mine]
    shares = (fit.matched * fit.in_depth)[mine] / (asked + 1.0)
    in_sight = asked >= _IN_SIGHT * fit.visible_px
    return float(shares.min(initial=1.0, where=in_sight))


def _library(u: Floats, side: str, squats: int) -> Floats:
    """Poses (L,3,4) of one leg spread evenly over what legs do, one of so many over those of squats with the knees out."""
    mirror = 1.0 if side == "left" else -1.0
    low = np.array([-1.9, -0.4, -0.3, 0.0])
    high = np.array([0.5, 0.4, 0.7, 2.2])
    angles = low + (high - low) * u[:, :4]
    low, high = np.array([-1.6, 0.2, 0.4, 1.4]), np.array([-0.5, 0.9, 2.2, 2.75])
    angles[::squats] = low + (high - low) * u[::squats, :4]
    thigh = angles[:, :3] * np.array([1.0, mirror, mirror])
    shank = np.zeros_like(thigh)
    shank[:, 0] = angles[:, 3]
    out = np.tile(usual_leg(side), (len(u), 1, 1))
    out[:, 0], out[:, 1] = rotations.exp(thigh), rotations.exp(shank)
    return out
