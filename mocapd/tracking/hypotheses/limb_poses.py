"""An arm or a leg that the pictures hardly confirm may be elsewhere: poses about it and over its whole range are tried."""

from dataclasses import replace

from mocapd.tracking.hypotheses.base import HypothesisContext, ScoredFit


class ArmPoses:
    """Other arms, where no trunk leads that knows them; see PoseHypothesis."""

    def reset(self) -> None:
        """See PoseHypothesis."""

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""
        at.solvers.arms.rehearse(now.fit.state, now.views)

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis."""
        if at.trunk_prior is not None:
            return now
        fit, sides = at.solvers.arms.improve(
            now.fit, now.views, at.dt_s, at.ticks.frame_index, now.terms
        )
        changed = (*now.changed, *(f"{side}_arm" for side in sides))
        return replace(now, fit=fit, changed=changed)


class LegPoses:
    """Other legs; see PoseHypothesis."""

    def reset(self) -> None:
        """See PoseHypothesis."""

    def rehearse(self, now: ScoredFit, at: HypothesisContext, /) -> None:
        """See PoseHypothesis."""
        at.solvers.legs.rehearse(now.fit.state, now.views)

    def test(self, now: ScoredFit, at: HypothesisContext) -> ScoredFit:
        """See PoseHypothesis."""
        fit, sides = at.solvers.legs.improve(
            now.fit, now.views, at.dt_s, at.ticks.frame_index, now.terms, at.trunk_prior
        )
        return replace(now, fit=fit, changed=(*now.changed, *(f"{side}_leg" for side in sides)))
