"""Reasons why no person is tracked."""

from enum import StrEnum


class LostReason(StrEnum):
    """Each reason comes with a description and a remedy for the user."""

    UNRECOGNISED = (
        "unrecognised"  # a person-sized region moved for seconds and failed the person checks
    )

    @property
    def what(self) -> str:
        """Description for the user."""
        return "somebody moves here who is not taken for a person"

    @property
    def fix(self) -> str:
        """Remedy for the user."""
        return "stand upright once, facing the cameras, the whole body in view of all of them"
