"""Who speaks."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Claim:
    """One tracker's, in this frame. known: it has a body, if only from a moment ago; live: with evidence of this frame;
    well: and enough of it; agrees: in the place of whoever speaks, or so long elsewhere that it is right."""

    name: str
    believed: bool
    known: bool
    live: bool
    well: bool
    agrees: bool


def chosen(speaker: str | None, claims: Sequence[Claim]) -> str | None:
    """Whose body is told, of the claims in the order of preference; None when nobody knows one.

    Who speaks goes on while it is believed, unless one that is preferred to it is believed too and agrees; or while it does
    well, unless a preferred one does as well; or while it is live, unless another is believed or does well. Else anyone who
    is live speaks. Nobody begins with a body of a moment ago.
    """
    now = next((one for one in claims if one.name == speaker), None)
    is_sure = now is not None and now.known and now.believed
    for one in claims:
        if one is now and is_sure:
            return one.name
        if one is now and one.well:
            break
        if one.believed and one.live and (one.agrees or not is_sure):
            return one.name
    for one in claims:
        if (one is now and one.live) or one.well:
            return one.name
    for one in claims:
        if one.live:
            return one.name
    return now.name if now is not None and now.known else None
