"""What is said of cameras that do not fit together, and of what would make them fit."""

from mocapd.calibrate.extrinsics.mirrored_pictures import Suspicion
from mocapd.calibrate.extrinsics.world_frame import PlayAreaError
from mocapd.errors import ConfigError


class ContradictionError(ConfigError):
    """The views of the cameras do not fit together, whatever the extrinsics."""


class MirroredError(ContradictionError):
    """They would fit if the pictures of a camera, or the back of the board, were turned round."""


def contradiction(
    rms_px: float, play_area: PlayAreaError | None, two_sided: bool
) -> ContradictionError:
    """Of cameras that fit so badly."""
    cm = "" if play_area is None else f", {play_area.median_cm:.1f} cm in the play area"
    second_page = "; the back of the board must be the second page, whose markers are mirrored"
    return ContradictionError(
        f"the cameras contradict each other: {rms_px:.2f} px{cm}",
        "the room",
        "hold the board still at each place, keep the cameras where they are, do not mirror "
        "a picture, and see that frames of one index are of one moment"
        + (second_page if two_sided else ""),
    )


def mirrored(told: Suspicion) -> MirroredError:
    """Of the cameras, or the back, that are suspected."""
    if told.upside_down:
        return MirroredError(
            "the back is upside down to the front, turned by 180 degrees",
            "the board",
            "glue it on so that each cross lies behind the cross with its own letter",
        )
    names = ", ".join(told.mirrored)
    either = f", or else those of {', '.join(told.others)}," if told.others else ""
    return MirroredError(
        f"the pictures{either} are mirrored: the others contradict them, and agree once they are turned round",
        names,
        "switch mirroring off in the camera or the recorder, and show the board anew, also for the lens",
    )
