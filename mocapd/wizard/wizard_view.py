"""The page's view of the wizard: a snapshot of its step."""

from dataclasses import dataclass, replace

from mocapd.errors import Problem
from mocapd.wizard.setup_keeper import UnfinishedSetup
from mocapd.wizard.step import Json, StepState, StepView
from mocapd.wizard.step_names import StepName


@dataclass(frozen=True, slots=True, eq=False)
class WizardView:
    """A snapshot: `serial` grows with every change; steps: the needed ones; done: the steps with their result in the
    draft; refused: why the last command was refused, or None; has_shirt: the wearer's answer."""

    serial: int
    step: StepName
    done: frozenset[StepName]
    view: StepView
    refused: Problem | None
    saved: bool
    ended: bool
    steps: tuple[StepName, ...] = tuple(StepName)
    has_shirt: bool = True


def with_offer(view: StepView, offer: UnfinishedSetup) -> StepView:
    """The step with the choice about an unfinished setup, which comes first."""
    offered: Json = {
        "when": offer.when.isoformat(),
        "done": [name.value for name in StepName if name in offer.done],
    }
    view = replace(view, details={**view.details, "kept": offered})
    if view.state is not StepState.DONE:
        return view
    sentence = "Say below whether to go on with the unfinished setup, or begin anew."
    return replace(view, state=StepState.WAITING, sentence=sentence)
