"""Profiles of the body tracker: the cues that each uses."""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class Profile:
    """The cues of a body tracker."""

    shirt: bool
    clothes: bool


PROFILES: Mapping[str, Profile] = MappingProxyType(
    {
        "auto": Profile(shirt=True, clothes=True),
        "shirt": Profile(shirt=True, clothes=False),
        "markerless": Profile(shirt=False, clothes=True),
    }
)
