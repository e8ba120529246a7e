"""Cameras that stopped while a step goes on."""

from collections.abc import Iterable

from mocapd.capture.thread import CaptureState
from mocapd.wizard.context import Context
from mocapd.wizard.step import Problem

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
