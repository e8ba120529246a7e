"""When a shirt is looked for: one that hardly agrees with the pictures while it is tracked, and one that is missing the less
often, the longer it is."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from mocapd.clock import nanoseconds
from mocapd.tracking.base import no_probe
from mocapd.tracking.cues.shirt.shirt_cue import ShirtEstimate
from mocapd.tracking.cues.shirt.shirt_locator import ShirtLocator
from mocapd.tracking.cues.shirt.shirt_params import ShirtParams


def located(match: float, found_elsewhere: ShirtEstimate | None) -> tuple[Any, Any]:
    """What was followed with this match, and what is located where a search finds this."""
    nothing: Any = None
    view: Any = SimpleNamespace()
    fit: Any = SimpleNamespace(match=match)
    followed = ShirtEstimate(fit, nothing, (), 0.0, redraw=False)
    cue: Any = SimpleNamespace(
        params=ShirtParams(),
        is_search_due=lambda _: True,
        search=lambda *_: found_elsewhere,
        follow=lambda *_: followed,
    )
    state: Any = SimpleNamespace(trunk=view, by_shirt=True)
    located = ShirtLocator(cue, nothing, 0.6).locate(
        state, nothing, nothing, 1 / 30, {}, 0, 0, True, (), no_probe
    )
    return followed, located


def test_after_a_search_that_found_nothing_better_the_body_is_drawn_again_to_learn_from_it() -> (
    None
):
    """The search drew others last."""
    followed, kept = located(0.5, None)
    assert kept.fit is followed.fit
    assert kept.redraw


def test_a_shirt_that_agrees_is_not_looked_for_elsewhere() -> None:
    followed, kept = located(0.9, None)
    assert kept is followed


def test_a_shirt_that_is_missing_for_long_is_looked_for_once_a_second() -> None:
    """Who takes a jacket off after a moment has the shirt again at once; who wears none pays little for `auto`."""
    nothing: Any = None
    cue: Any = SimpleNamespace(
        params=ShirtParams(), is_search_due=lambda _: False, start_from=lambda *_: None
    )
    state: Any = SimpleNamespace(trunk=None, by_shirt=False, taught_s=0.0)
    locator, tried_s = ShirtLocator(cue, nothing, 0.6), []
    for k in range(30 * 20):
        at = nanoseconds(k / 30)
        locator.locate(state, nothing, nothing, 1 / 30, {}, at, k, False, (), no_probe)
        if locator.has_searched:
            tried_s.append(k / 30)
    pauses_s = np.diff(tried_s)
    assert pauses_s[:4].max() <= 0.24
    assert 0.9 <= pauses_s[-1] <= 1.04
