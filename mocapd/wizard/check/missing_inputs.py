"""What the step Check needs of the other steps before it can track."""

from collections.abc import Iterator

from mocapd.errors import Problem
from mocapd.wizard.draft import Draft


def missing_inputs(draft: Draft) -> Iterator[Problem]:
    if draft.rig is None:
        yield Problem("where the cameras stand is not known", "room", "do the step Room first")
    elif draft.has_shirt and not draft.colours:
        yield Problem(
            "the shirt's colours in this light are not known",
            "colour",
            "do the step Colour first",
        )
    elif not draft.has_shirt and len(draft.rig.cameras) < 2:
        yield Problem(
            "one camera alone cannot track without a shirt",
            "cameras",
            "add a second camera in the step Cameras, or wear the shirt",
        )
    if draft.stature_m is None:
        yield Problem("the wearer's stature is not known", "body", "type it in the step Body")
