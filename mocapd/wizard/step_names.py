"""Names of the wizard's steps, in order, and when each is done."""

from collections.abc import Callable, Mapping, Sequence
from enum import StrEnum

from mocapd.wizard.draft import Draft


class StepName(StrEnum):
    """The steps in their order."""

    CAMERAS = "cameras"
    LENS = "lens"
    ROOM = "room"
    COLOUR = "colour"
    BODY = "body"
    CHECK = "check"


def _ids(draft: Draft) -> set[str]:
    return {camera.id for camera in draft.cameras}


_IS_DONE: Mapping[StepName, Callable[[Draft, bool], bool]] = {
    StepName.CAMERAS: lambda draft, _: bool(draft.cameras),
    StepName.LENS: lambda draft, _: bool(draft.cameras) and _ids(draft) <= draft.intrinsics.keys(),
    StepName.ROOM: lambda draft, _: draft.rig is not None and _ids(draft) == set(draft.rig.names),
    StepName.COLOUR: lambda draft, _: bool(draft.cameras) and _ids(draft) <= draft.colours.keys(),
    StepName.BODY: lambda draft, _: draft.stature_m is not None,
    StepName.CHECK: lambda _, saved: saved,
}
"""Whether the result of a step is in the draft; the flag says whether the draft was saved since the start."""


def steps_wanted(names: Sequence[StepName], draft: Draft) -> tuple[StepName, ...]:
    """The steps that this setup needs: without a shirt none that concern it."""
    return tuple(name for name in names if draft.has_shirt or name is not StepName.COLOUR)


def after_shirt(shown: StepName, names: Sequence[StepName], draft: Draft) -> StepName | None:
    """The step to show after a choice about the shirt; None: the present one stays."""
    if shown not in (StepName.COLOUR, StepName.BODY, StepName.CHECK):
        return None
    if StepName.COLOUR in names and not _IS_DONE[StepName.COLOUR](draft, False):
        return StepName.COLOUR
    if shown in names:
        return shown  # again: its questions differ
    return next(
        name for name in (*names, StepName.CHECK) if name in (StepName.BODY, StepName.CHECK)
    )


def steps_done(draft: Draft, saved: bool) -> frozenset[StepName]:
    """The steps with their result in the draft; saved: whether it was saved since the start."""
    return frozenset(name for name, is_done in _IS_DONE.items() if is_done(draft, saved))
