"""A question in the step Cameras about a webcam in another USB port than when it was calibrated; asked once.

Its command is `step_commands.PORTS`. Details: moved: [{camera, was, now}] not yet answered.
"""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace

from mocapd.calibration.calibration_file import calibration_path
from mocapd.calibration.calibration_writing import rewrite_sources
from mocapd.capture.kinds.source_kinds import identities_of
from mocapd.capture.webcam.identity import WebcamIdentity, match_identity, parse_identity
from mocapd.errors import InputError, MocapdError, Problem, UnavailableError
from mocapd.wizard.commands import Command, Verbs
from mocapd.wizard.context import Context, StepAround
from mocapd.wizard.draft import Draft, DraftCamera, without_room
from mocapd.wizard.step import StepState, StepView, T
from mocapd.wizard.step_commands import PORTS, SamePort
from mocapd.wizard.wizard import MakeStep


@dataclass(frozen=True, slots=True)
class PortChange:
    """A calibrated webcam in another port: its old and new address."""

    camera: str
    was: str
    now: str


def find_port_changes(
    saved: Sequence[DraftCamera], present: Sequence[WebcamIdentity]
) -> tuple[PortChange, ...]:
    """The saved webcams that are in another port now."""
    identities = identities_of((camera.id, camera.source) for camera in saved)
    moved = []
    for name, wanted in identities.items():
        others = [identity for other, identity in identities.items() if other != name]
        try:
            match = match_identity(wanted, present, others)
        except UnavailableError:  # unplugged, or several identical candidates
            continue
        if match.moved:
            moved.append(PortChange(name, str(wanted), str(match.identity)))
    return tuple(moved)


def same_camera(draft: Draft, moved: PortChange) -> Draft:
    """The draft with the camera at its new port."""
    return replace(
        draft,
        cameras=tuple(
            replace(camera, source=moved.now) if camera.id == moved.camera else camera
            for camera in draft.cameras
        ),
    )


def other_camera(draft: Draft, moved: PortChange) -> Draft:
    """The draft without the data of the previous camera, and of its room."""
    draft = without_room(same_camera(draft, moved))
    return replace(
        draft,
        intrinsics=_without(draft.intrinsics, moved.camera),
        intrinsics_saved=draft.intrinsics_saved - {moved.camera},
        colours=_without(draft.colours, moved.camera),
    )


def _without(values: Mapping[str, T], name: str) -> dict[str, T]:
    return {key: value for key, value in values.items() if key != name}


class AsksForPorts(StepAround):
    """Wraps the step Cameras with the question; see the module's docstring, and Step.

    moved: shared by all visits of the step, so that no question is repeated.
    """

    def __init__(self, context: Context, make: MakeStep, moved: list[PortChange]) -> None:
        super().__init__(make(context))
        self._context, self._moved = context, moved
        self._trouble: tuple[Problem, ...] = ()

    @property
    def verbs(self) -> Verbs:
        return {**self.inner.verbs, **PORTS}

    def command(self, command: Command) -> None:
        if not isinstance(command, SamePort):
            self.inner.command(command)
            return
        asked = [change for change in self._moved if change.camera == command.camera]
        if not asked:
            raise InputError("nothing is asked of this camera", "the page", "reload the page")
        if command.same:
            self._remember(asked[0])
        else:
            self._context.draft = other_camera(self._context.draft, asked[0])
        self._moved.remove(asked[0])

    def view(self) -> StepView:
        view = self.inner.view()
        questions = tuple(
            Problem(
                f"a camera like it was in USB port {_port(change.was)}, and is now in {_port(change.now)}",
                change.camera,
                "say below whether it is the same camera",
            )
            for change in self._moved
        )
        details = {**view.details, "moved": [asdict(change) for change in self._moved]}
        view = replace(view, problems=questions + self._trouble + view.problems, details=details)
        if not self._moved or view.state is not StepState.DONE:
            return view
        names = " and ".join(change.camera for change in self._moved)
        sentence = f"Say below whether {names} is the camera that was calibrated before."
        return replace(view, state=StepState.WAITING, sentence=sentence)

    def _remember(self, moved: PortChange) -> None:
        """Store in the draft and in the saved calibration; a failed write is shown, and asked about again."""
        self._context.draft = same_camera(self._context.draft, moved)
        try:
            rewrite_sources(calibration_path(self._context.state_dir), {moved.camera: moved.now})
        except MocapdError as error:
            self._trouble = (Problem.of(error),)


def _port(source: str) -> str:
    return parse_identity(source).port_path
