"""How right proposed strokes are, against exact labels or a user's own strokes."""

from dataclasses import dataclass

import numpy as np

from mocapd.body.areas import N_AREAS
from mocapd.shirt.colour.white_balance import frobenius_distance
from mocapd.shirt.standard_shirt import standard_shirt
from mocapd.types import Bytes, Floats

_LEAST_PX = 40  # a patch of fewer pixels is hardly visible


@dataclass(frozen=True, slots=True)
class ProposalScore:
    """right: share of the judged stroke pixels whose colour is true; patches: share of the visible
    patches' area that lies in patches with a right stroke; covered: share of the judged area under
    right strokes; W_error: Frobenius distance to the white balance of the user's strokes."""

    right: float
    patches: float
    covered: float
    W_error: float


def score_by_labels(strokes: Bytes, patch: Bytes, W: Floats, W_user: Floats) -> ProposalScore:
    """Score strokes (H,W) 0..10 against exact patch indices (H,W) 0..20."""
    truth = standard_shirt().colour_of_patch[patch]
    area = right_area = 0
    for index in range(1, N_AREAS):
        here = patch == index
        n = int(here.sum())
        if n < _LEAST_PX:
            continue
        area += n
        drawn = strokes[here]
        correct = int((drawn == standard_shirt().colour_of_patch[index]).sum())
        if correct > 0 and 2 * correct > int((drawn > 0).sum()):
            right_area += n
    drawn_on = strokes > 0
    return ProposalScore(
        right=_share(drawn_on & (strokes == truth), drawn_on),
        patches=right_area / max(area, 1),
        covered=_share((strokes == truth) & (truth > 0), truth > 0),
        W_error=frobenius_distance(W, W_user),
    )


def score_by_strokes(strokes: Bytes, user: Bytes, W: Floats, W_user: Floats) -> ProposalScore:
    """Score strokes (H,W) where a user drew too (H,W); a user's stroke stands for its patch."""
    both = (strokes > 0) & (user > 0)
    drawn = area = 0
    for colour in range(1, 11):
        here = user == colour
        area += int(here.sum())
        mine = strokes[here]
        correct = int((mine == colour).sum())
        if correct > 0 and 2 * correct > int((mine > 0).sum()):
            drawn += int(here.sum())
    return ProposalScore(
        right=_share(both & (strokes == user), both),
        patches=drawn / max(area, 1),
        covered=_share((strokes == user) & (user > 0), user > 0),
        W_error=frobenius_distance(W, W_user),
    )


def table(scores: dict[str, ProposalScore]) -> str:
    """One line per picture."""
    lines = [f"{'picture':40s} right [%]  patches [%]  covered [%]  W error"]
    lines += [
        f"{name:40s} {100 * s.right:9.1f} {100 * s.patches:12.1f} {100 * s.covered:12.1f} {s.W_error:8.3f}"
        for name, s in scores.items()
    ]
    return "\n".join(lines)


def _share(part: np.ndarray, whole: np.ndarray) -> float:
    n = int(whole.sum())
    return float(part.sum()) / n if n else 0.0
