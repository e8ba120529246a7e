"""What the page may see of the wizard: a snapshot of its step."""

from dataclasses import dataclass, replace

from mocapd.errors import Problem
from mocapd.wizard.draft_file import KeptSetup
from mocapd.wizard.step import Json, StepState, StepView
from mocapd.wizard.step_names import StepName


@dataclass(frozen=True, slots=True, eq=False)
class WizardView:
    """A snapshot: `serial` grows with every change; steps: those there are; done: the steps whose result
    is in the draft; refused: why the last command was not taken, None when it was; has_shirt: whether the
    wearer said to have one."""

    serial: int
    step: StepName
    done: frozenset[StepName]
    view: StepView
    refused: Problem | None
    saved: bool
    ended: bool
    steps: tuple[StepName, ...] = tuple(StepName)
    has_shirt: bool = True


def with_offer(view: StepView, offer: KeptSetup) -> StepView:
    """Nobody goes on before the choice is made."""
    kept: Json = {
        "when": offer.when.isoformat(),
        "done": [name.value for name in StepName if name in offer.done],
    }
    view = replace(view, details={**view.details, "kept": kept})
    if view.state is not StepState.DONE:
        return view
    sentence = "Say below whether to go on with the setup that is kept, or begin anew."
    return replace(view, state=StepState.WAITING, sentence=sentence)
