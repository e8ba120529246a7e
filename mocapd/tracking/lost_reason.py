"""Why nobody is tracked, where a tracker can tell."""

from enum import StrEnum


class LostReason(StrEnum):
    """What keeps a tracker from tracking somebody; each says what is the case, and what the person can do."""

    UNRECOGNISED = "unrecognised"  # for seconds something as large as a person has moved that is not taken for one

    @property
    def what(self) -> str:
        """For people."""
        return "somebody moves here who is not taken for a person"

    @property
    def fix(self) -> str:
        """For people."""
        return "stand upright once, facing the cameras, the whole body in view of all of them"
