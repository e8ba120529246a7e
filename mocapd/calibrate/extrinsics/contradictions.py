"""Errors about cameras that do not fit together, with remedies."""

from mocapd.calibrate.extrinsics.mirrored_pictures import Suspicion
from mocapd.calibrate.extrinsics.world_frame import PlayAreaError
from mocapd.errors import ConfigError


class ContradictionError(ConfigError):
    """The views of the cameras do not fit together, whatever the extrinsics."""


class MirroredError(ContradictionError):
    """They would fit if the pictures of a camera, or the back of the board, were mirrored back."""


def contradiction(
    rms_px: float, play_area: PlayAreaError | None, two_sided: bool
) -> ContradictionError:
    """The error for cameras that fit this badly."""
    cm = "" if play_area is None else f", {play_area.median_cm:.1f} cm in the play area"
    second_page = "; the back of the board must be the second page, whose markers are mirrored"
    return ContradictionError(
        f"the cameras contradict each other: {rms_px:.2f} px{cm}",
        "the room",
        "hold the board still at each place, keep the cameras where they are, do not mirror "
        "a picture, and see that frames of one index are of one moment"
        + (second_page if two_sided else ""),
    )


def mirrored_error(suspicion: Suspicion) -> MirroredError:
    """The error for suspected cameras, or a suspected back."""
    if suspicion.upside_down:
        return MirroredError(
            "the back is upside down to the front, turned by 180 degrees",
            "the board",
            "glue it on so that each cross lies behind the cross with its own letter",
        )
    names = ", ".join(suspicion.mirrored)
    either = f", or else those of {', '.join(suspicion.others)}," if suspicion.others else ""
    return MirroredError(
        f"the pictures{either} are mirrored: the others contradict them, and agree once they are turned round",
        names,
        "switch mirroring off in the camera or the recorder, and show the board again, also for the lens",
    )
