"""Problems of stopped cameras, and of too few cameras."""

from collections.abc import Iterable

from mocapd.capture.camera_thread.capture_status import CaptureState
from mocapd.errors import Problem
from mocapd.wizard.context import Context
from mocapd.wizard.draft import Draft

FEWEST_WITHOUT_SHIRT = 2
_FIX = "plug it in again: the step goes on by itself; or leave it out in the step Cameras"


def stopped_cameras(context: Context, ids: Iterable[str]) -> tuple[Problem, ...]:
    """One for each camera that gives no pictures now, with the reason."""
    statuses = context.statuses()
    labels = {camera.id: camera.label or camera.id for camera in context.draft.cameras}
    return tuple(
        Problem(f"the camera stopped: {statuses[id_].reason or 'no pictures'}", labels[id_], _FIX)
        for id_ in ids
        if id_ in statuses and statuses[id_].state in (CaptureState.LOST, CaptureState.ENDED)
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
