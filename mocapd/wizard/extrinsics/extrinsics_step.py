"""The step Room delegates to the chosen method, the board or the wearer alone.

Its commands are `step_commands.ROOM` and the method's own.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from types import MappingProxyType

from mocapd.errors import InputError, Problem
from mocapd.types import Rig
from mocapd.wizard.commands import Command, Verbs
from mocapd.wizard.context import Context, Step, StepAround
from mocapd.wizard.extrinsics.extrinsics_with_board import ExtrinsicsWithBoard
from mocapd.wizard.extrinsics.extrinsics_with_wearer import ExtrinsicsWithWearer
from mocapd.wizard.extrinsics.rig_plan import advice_of, area_shapes
from mocapd.wizard.step import Shape, StepState, StepView
from mocapd.wizard.step_commands import ROOM, Method

METHODS: Mapping[str, Callable[[Context], Step]] = MappingProxyType(
    {"board": ExtrinsicsWithBoard, "wearer": ExtrinsicsWithWearer}
)


class ExtrinsicsStep(StepAround):
    """A Step that delegates to the chosen method; at first the board's."""

    def __init__(self, context: Context) -> None:
        """Raises InputError when intrinsics are missing."""
        missing = [
            c.label or c.id for c in context.draft.cameras if c.id not in context.draft.intrinsics
        ]
        if missing or not context.draft.cameras:
            raise InputError(
                f"the lens of {', '.join(missing)} is not known" if missing else "no cameras",
                "room",
                "do the step Lens first",
            )
        super().__init__(METHODS["board"](context))
        self._context = context
        self._method_name = "board"
        self._advised_rig: Rig | None = None
        self._advised: tuple[Problem, ...] = ()
        self._area: Mapping[str, tuple[Shape, ...]] = {}

    def tick(self, now_ns: int) -> None:
        """See Step. Without the shirt only the board's method is available."""
        if not self._context.draft.has_shirt and self._context.job is None:
            self._choose("board")
        self.inner.tick(now_ns)

    @property
    def verbs(self) -> Verbs:
        return {**self.inner.verbs, **ROOM}

    def command(self, command: Command) -> None:
        if isinstance(command, Method):
            self._choose(command.method)
        else:
            self.inner.command(command)

    def view(self) -> StepView:
        view = self.inner.view()
        methods = list(METHODS) if self._context.draft.has_shirt else ["board"]
        details = {**view.details, "method": self._method_name, "methods": methods}
        if view.state is not StepState.DONE:
            return replace(view, details=details)
        self._advise()
        problems = (*view.problems, *self._advised)
        return replace(view, details=details, problems=problems, overlays=self._area)

    def _advise(self) -> None:
        """Advice on the rig, and the play area in the pictures; computed once per rig."""
        rig = self._context.draft.rig
        if rig is not self._advised_rig:
            self._advised_rig, self._advised = rig, advice_of(rig)
            self._area = area_shapes(rig)

    def _choose(self, name: str) -> None:
        if name == self._method_name:
            return
        if name == "wearer" and not self._context.draft.has_shirt:
            raise InputError(
                "a room without a board is found by the shirt", "room", "show the board"
            )
        if self._context.job is not None:
            raise InputError("something is being worked out", "room", "wait a moment")
        made = METHODS[name](self._context)
        self.inner.leave()
        self._method_name, self.inner = name, made
        made.enter()
