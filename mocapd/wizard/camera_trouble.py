"""Problems of stopped cameras, and of too few cameras."""

from mocapd.capture.camera_thread.capture_status import CaptureState
from mocapd.errors import Problem
from mocapd.wizard.context import Context
from mocapd.wizard.draft import Draft

FEWEST_WITHOUT_SHIRT = 2
_FIX = "plug it in again: the step goes on by itself; or leave it out in the step Cameras"


def stopped_cameras(context: Context) -> tuple[Problem, ...]:
    """One for each camera of the draft that gives no pictures now, with the reason."""
    statuses = context.statuses()
    return tuple(
        Problem(
            f"the camera stopped: {statuses[camera.id].reason or 'no pictures'}",
            camera.label or camera.id,
            _FIX,
        )
        for camera in context.draft.cameras
        if camera.id in statuses
        and statuses[camera.id].state in (CaptureState.LOST, CaptureState.ENDED)
    )


def too_few_cameras(draft: Draft, cameras: int) -> Problem | None:
    """The problem of too few cameras for tracking without the shirt; None where they suffice."""
    if draft.has_shirt or cameras >= FEWEST_WITHOUT_SHIRT:
        return None
    return Problem(
        "without the shirt two cameras are needed",
        "cameras",
        "plug in a second one and start the setup again, or say that you have the shirt",
    )
