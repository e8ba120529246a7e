"""Ablations: each leaves out one step, as the setting of the same name does, and builds a tracker that steps."""

import numpy as np
import pytest

from lab.compared.ablations import FLEX_ABLATIONS, FLEX_PAPER_ABLATIONS
from lab.compared.rivals import RIVALS, ready_rival
from mocapd.trackers.flex.build import params_of
from mocapd.trackers.flex.params import Params
from mocapd.trackers.flex.section import FlexSection
from mocapd.trackers.flex_paper.build import params_of as paper_params_of
from mocapd.trackers.flex_paper.params import Params as PaperParams
from mocapd.trackers.flex_paper.section import FlexPaperSection
from mocapd.trackers.registry import TRACKERS, Resources
from tests.trackers.flex.plain_film import plain_film

pytestmark = pytest.mark.kernels


def setting(label: str) -> str:
    """The key of [tracker.<name>] that leaves out the same step."""
    return label.removeprefix("no ").removeprefix("not ").replace(" ", "_").replace("-", "_")


def test_each_ablation_changes_one_step_of_the_tracker_without_a_shirt() -> None:
    for label, edit in FLEX_ABLATIONS.items():
        assert edit(Params()) == params_of(FlexSection(**{setting(label): False}))
    edited = [edit(Params()) for edit in FLEX_ABLATIONS.values()]
    assert all(one != Params() and edited.count(one) == 1 for one in edited)


def test_each_ablation_changes_one_step_of_the_published_tracker() -> None:
    for label, edit in FLEX_PAPER_ABLATIONS.items():
        changed = edit(PaperParams())
        assert changed == paper_params_of(FlexPaperSection(**{setting(label): False}))
        assert changed != PaperParams()


def test_every_tracker_that_is_compared_exists() -> None:
    assert set(RIVALS) <= set(TRACKERS)


@pytest.mark.parametrize("label", ["paper", "no joints"])
def test_a_rival_of_the_tracker_without_a_shirt_steps(label: str) -> None:
    film = plain_film()
    ready = ready_rival(RIVALS["flex"][label], Resources(), film.known)
    track = ready.tracker.step(film.frames[0], ready.shape)
    assert track.body.t_ns == film.frames[0].t_ns
    assert np.isfinite(ready.shape.factors).all()
