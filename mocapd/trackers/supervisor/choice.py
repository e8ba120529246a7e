"""Who speaks."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Claim:
    """One tracker's, in this frame. known: it has a body, if only from a moment ago; agrees: in the place of whoever
    speaks, or so long elsewhere that it is right."""

    name: str
    believed: bool
    live: bool
    known: bool
    agrees: bool


def chosen(speaker: str | None, claims: Sequence[Claim]) -> str | None:
    """Whose body is told, of the claims in the order of preference; None when nobody knows one.

    Who speaks goes on while it is believed, unless one that is preferred to it is believed too and agrees. When
    nobody is believed it goes on while it is live, and then while it coasts, if nobody else is live.
    """
    by_name = {one.name: one for one in claims}
    now = by_name.get(speaker) if speaker is not None else None
    for one in claims:
        if one is now and one.believed:
            return one.name
        if one.believed and (one.agrees or now is None or not now.believed):
            return one.name
    if now is not None and now.live:
        return now.name
    for one in claims:
        if one.live:
            return one.name
    return now.name if now is not None and now.known else _first_known(claims)


def _first_known(claims: Sequence[Claim]) -> str | None:
    return next((one.name for one in claims if one.known), None)
